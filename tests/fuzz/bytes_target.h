// The entry points of a fuzzer whose inputs are bytes that protobuf's parsers may read.
#pragma once

#include <google/protobuf/stubs/logging.h>

#include <cstdint>
#include <string_view>

// `run` takes a std::string_view.
#define GRASPDB_FUZZ_BYTES(run)                                                       \
  extern "C" int LLVMFuzzerInitialize(int*, char***) {                                \
    google::protobuf::SetLogHandler(nullptr);                                         \
    return 0;                                                                         \
  }                                                                                   \
  extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) { \
    run(std::string_view(reinterpret_cast<const char*>(data), size));                 \
    return 0;                                                                         \
  }
