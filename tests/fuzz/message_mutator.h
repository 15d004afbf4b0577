// Mutations of protobuf messages: fields, not bytes, so that nearly every input is a valid message.
#pragma once

#include <google/protobuf/message.h>

#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace graspdb::fuzz {

// Changes messages in place, by a few fields at a time. Deterministic for a seed, except for
// changes by libFuzzer's LLVMFuzzerMutate to strings and bytes. Not thread-safe.
class MessageMutator {
 public:
  // `words` are occasional values of string fields, such as existing names.
  MessageMutator(std::uint32_t seed, const std::vector<std::string>& words)
      : random_(seed), words_(words) {}

  void Mutate(google::protobuf::Message& message);

  // Puts a part of `from` (a message of the same type) in the place of one of the same type in
  // `into`.
  void Cross(const google::protobuf::Message& from, google::protobuf::Message& into);

 private:
  // A field of a message that may be changed.
  struct Slot {
    google::protobuf::Message* message;
    const google::protobuf::FieldDescriptor* field;
  };

  std::size_t Pick(std::size_t count) { return random_() % count; }
  bool OneIn(std::size_t chances) { return Pick(chances) == 0; }

  static void Collect(google::protobuf::Message& message, std::vector<Slot>& out);
  static void CollectMessages(google::protobuf::Message& message,
                              std::vector<google::protobuf::Message*>& out);
  void MutateSlot(const Slot& slot);
  void MutateSingular(const Slot& slot);
  void MutateRepeated(const Slot& slot);
  void SetElement(const Slot& slot, int index);
  void AddElement(const Slot& slot);

  std::int64_t NewInteger(std::int64_t old);
  double NewNumber(double old);
  int NewEnum(const google::protobuf::FieldDescriptor& field);
  std::string NewText(std::string old);
  std::string NewBytes(std::string old);
  std::string NewFloats(std::string old);
  std::string NewSize(std::string old);

  std::minstd_rand random_;
  const std::vector<std::string>& words_;
};

}  // namespace graspdb::fuzz
