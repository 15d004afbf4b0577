# What every target of ours is compiled with; generated code and other people's
# headers are SYSTEM and stay out of it.
add_library(graspdb_options INTERFACE)
target_include_directories(graspdb_options INTERFACE ${CMAKE_SOURCE_DIR})
target_compile_options(graspdb_options INTERFACE -Wall -Wextra -Wconversion -Wshadow -Werror)

# Same input, same bytes: no contraction that differs from one machine to the next.
add_compile_options(-ffp-contract=off)

if(GRASPDB_SANITIZE)
  add_compile_options(-fsanitize=${GRASPDB_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${GRASPDB_SANITIZE})
  if(GRASPDB_SANITIZE MATCHES undefined)
    # Looking at each reference that Eigen passes on takes half of the compiler's time (22 s become
    # 7 for recognition/models/fusion.cc) and finds little that the address sanitizer does not.
    add_compile_options(-fno-sanitize=null,alignment,vptr,object-size)
  endif()
  # Under a sanitizer Eigen would choose another allocator than Debian's libpcl was built
  # with, and the one would free what the other allocated.
  add_compile_definitions(EIGEN_MALLOC_ALREADY_ALIGNED=1)
endif()

if(GRASPDB_SANITIZE MATCHES thread)
  # Debian's libraries are built without it: with the macro, protobuf's headers would give a map
  # one more member than libprotobuf knows of.
  add_compile_options(-U__SANITIZE_THREAD__)
  # See the file; for programs only, so that each has it once.
  add_library(graspdb_thread_sanitizer OBJECT ${CMAKE_SOURCE_DIR}/tests/sanitizers/thread_sanitizer.cc)
  link_libraries(
    "$<$<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>:$<TARGET_OBJECTS:graspdb_thread_sanitizer>>")
endif()
