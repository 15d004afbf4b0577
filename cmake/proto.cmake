# graspdb_proto_library(TARGET ROOT dir [GRPC] [IMPORTS dir ...] FILES a.proto b.proto ...):
# a static library with the generated C++ of the files, which are named relative to ROOT;
# their imports are searched for in IMPORTS too.
find_program(PROTOC protoc REQUIRED)
find_program(GRPC_CPP_PLUGIN grpc_cpp_plugin REQUIRED)

function(graspdb_proto_library target)
  cmake_parse_arguments(ARG "GRPC" "ROOT" "FILES;IMPORTS" ${ARGN})
  set(out ${CMAKE_BINARY_DIR}/gen)
  set(generated "")
  list(TRANSFORM ARG_IMPORTS PREPEND -I)
  foreach(file ${ARG_FILES})
    string(REGEX REPLACE "\\.proto$" "" stem ${file})
    set(products ${out}/${stem}.pb.cc ${out}/${stem}.pb.h)
    set(plugin "")
    if(ARG_GRPC AND stem MATCHES "_service$")
      list(APPEND products ${out}/${stem}.grpc.pb.cc ${out}/${stem}.grpc.pb.h)
      set(plugin --grpc_out=${out} --plugin=protoc-gen-grpc=${GRPC_CPP_PLUGIN})
    endif()
    add_custom_command(
      OUTPUT ${products}
      COMMAND ${CMAKE_COMMAND} -E make_directory ${out}
      COMMAND ${PROTOC} -I ${ARG_ROOT} ${ARG_IMPORTS} --cpp_out=${out} ${plugin} ${ARG_ROOT}/${file}
      DEPENDS ${ARG_ROOT}/${file}
      VERBATIM)
    list(APPEND generated ${products})
  endforeach()
  add_library(${target} STATIC ${generated})
  # protoc generates statics of the same names in each file.
  set_target_properties(${target} PROPERTIES UNITY_BUILD OFF)
  # Generated code is protobuf's to check, and its libraries have no sanitizer either: that saves compile
  # time. Fuzzers are guided by the parts of it that they reach.
  if(GRASPDB_SANITIZE AND NOT GRASPDB_SANITIZE MATCHES fuzzer)
    target_compile_options(${target} PRIVATE -fno-sanitize=all -O0)
  endif()
  target_include_directories(${target} SYSTEM
    PUBLIC $<BUILD_INTERFACE:${out}> $<INSTALL_INTERFACE:include>)
  target_link_libraries(${target} PUBLIC protobuf::libprotobuf)
  if(ARG_GRPC)
    target_link_libraries(${target} PUBLIC gRPC::grpc++)
  endif()
endfunction()
