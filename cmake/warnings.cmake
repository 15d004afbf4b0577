# Compile options of every target; generated code and third-party headers are SYSTEM and excluded.
add_library(graspdb_options INTERFACE)
target_include_directories(graspdb_options INTERFACE ${CMAKE_SOURCE_DIR})
target_compile_options(graspdb_options INTERFACE -Wall -Wextra -Wconversion -Wshadow -Werror)

# Same input, same bytes: no contraction that differs between machines.
add_compile_options(-ffp-contract=off)

# g++ collects garbage less often (its default at 24 GB of memory is 128 MB): 10 % less time, at most
# 1.5 GB for a translation unit.
add_compile_options("$<$<COMPILE_LANG_AND_ID:CXX,GNU>:--param=ggc-min-heapsize=500000>")

if(GRASPDB_SANITIZE)
  add_compile_options(-fsanitize=${GRASPDB_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${GRASPDB_SANITIZE})
  if(GRASPDB_SANITIZE MATCHES undefined)
    # Checking each reference in Eigen takes half of the compile time (22 s become 7 for
    # recognition/models/surface_model.cc) and finds little that the address sanitizer does not.
    add_compile_options(-fno-sanitize=null,alignment,vptr,object-size)
  endif()
  # Under a sanitizer Eigen would choose another allocator than Debian's libpcl was built with,
  # and one would free memory of the other.
  add_compile_definitions(EIGEN_MALLOC_ALREADY_ALIGNED=1)
endif()

if(GRASPDB_SANITIZE MATCHES thread)
  # The suppressions name inline functions by their scopes, which -g1 leaves out.
  add_compile_options("$<$<COMPILE_LANG_AND_ID:CXX,Clang>:-fdebug-info-for-profiling>")
  # Debian's libraries are built without it: with the macro, a map in protobuf's headers would have
  # one member more than in libprotobuf.
  add_compile_options(-U__SANITIZE_THREAD__)
  # It does not support fences; the locks of Asio's queues give the same order.
  add_compile_definitions(ASIO_DISABLE_FENCED_BLOCK)
  # For programs only, so that each has it once; see the file.
  add_library(graspdb_thread_sanitizer OBJECT ${CMAKE_SOURCE_DIR}/tests/sanitizers/thread_sanitizer.cc)
  link_libraries(
    "$<$<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>:$<TARGET_OBJECTS:graspdb_thread_sanitizer>>")
endif()
