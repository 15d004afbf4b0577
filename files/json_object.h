// JSON documents, built key by key.
#pragma once

#include <google/protobuf/struct.pb.h>

#include <cstddef>
#include <string>

#include "absl/status/statusor.h"

namespace graspdb::client {

// Fills an object, one key after the other.
class JsonObject {
 public:
  explicit JsonObject(google::protobuf::Value* value) : JsonObject(value->mutable_struct_value()) {}
  explicit JsonObject(google::protobuf::Struct* object) : fields_(object->mutable_fields()) {}

  // JSON cannot represent numbers that are not finite: they become null.
  void Number(const std::string& key, double number);
  void Count(const std::string& key, std::size_t n) { Number(key, static_cast<double>(n)); }
  void Text(const std::string& key, const std::string& text) { At(key).set_string_value(text); }
  void Bool(const std::string& key, bool value) { At(key).set_bool_value(value); }
  void Null(const std::string& key) { At(key).set_null_value(google::protobuf::NULL_VALUE); }
  google::protobuf::Value& At(const std::string& key) { return (*fields_)[key]; }

 private:
  google::protobuf::Map<std::string, google::protobuf::Value>* fields_;
};

enum class JsonLayout { kOneLine, kIndented };

// The document with its keys in alphabetical order: the same document gives the same bytes.
// INTERNAL when the library rejects it.
absl::StatusOr<std::string> PrintDocument(const google::protobuf::Struct& document,
                                          JsonLayout layout);

}  // namespace graspdb::client
