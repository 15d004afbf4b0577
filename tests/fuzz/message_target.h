// The entry points of a fuzzer whose inputs are serialized messages of one type.
#pragma once

#include <google/protobuf/stubs/logging.h>

#include <cstdint>
#include <string>
#include <vector>

#include "tests/fuzz/message_mutator.h"

namespace graspdb::fuzz {

// Writes `message` to `data`; 0 bytes if it does not fit, which makes libFuzzer retry.
inline std::size_t Put(const google::protobuf::Message& message, std::uint8_t* data,
                       std::size_t max_size) {
  const std::size_t size = message.ByteSizeLong();
  if (size > max_size || !message.SerializeToArray(data, static_cast<int>(size))) return 0;
  return size;
}

template <typename Message>
Message Parsed(const std::uint8_t* data, std::size_t size) {
  Message message;
  if (!message.ParseFromArray(data, static_cast<int>(size))) message.Clear();
  return message;
}

}  // namespace graspdb::fuzz

// `words` as for MessageMutator; `run` takes a const Message&.
#define GRASPDB_FUZZ_MESSAGES(Message, words, run)                                          \
  extern "C" int LLVMFuzzerInitialize(int*, char***) {                                      \
    google::protobuf::SetLogHandler(nullptr);                                               \
    return 0;                                                                               \
  }                                                                                         \
  extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,      \
                                                 std::size_t max_size, unsigned int seed) { \
    auto message = graspdb::fuzz::Parsed<Message>(data, size);                              \
    graspdb::fuzz::MessageMutator(seed, words).Mutate(message);                             \
    return graspdb::fuzz::Put(message, data, max_size);                                     \
  }                                                                                         \
  extern "C" std::size_t LLVMFuzzerCustomCrossOver(                                         \
      const std::uint8_t* a, std::size_t a_size, const std::uint8_t* b, std::size_t b_size, \
      std::uint8_t* out, std::size_t max_size, unsigned int seed) {                         \
    auto message = graspdb::fuzz::Parsed<Message>(a, a_size);                               \
    graspdb::fuzz::MessageMutator(seed, words)                                              \
        .Cross(graspdb::fuzz::Parsed<Message>(b, b_size), message);                         \
    return graspdb::fuzz::Put(message, out, max_size);                                      \
  }                                                                                         \
  extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {       \
    Message message;                                                                        \
    if (message.ParseFromArray(data, static_cast<int>(size))) run(message);                 \
    return 0;                                                                               \
  }
