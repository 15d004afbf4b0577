// JSON documents without a schema.
#pragma once

#include <google/protobuf/struct.pb.h>

#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "absl/status/statusor.h"

namespace graspdb::files {

// Null where the number is not finite, which JSON cannot represent.
google::protobuf::Value JsonNumber(double number);

// A boolean, a number, a text, a value, or a list of these.
template <typename T>
google::protobuf::Value JsonValue(const T& content) {
  google::protobuf::Value out;
  if constexpr (std::is_same_v<T, google::protobuf::Value>) {
    out = content;
  } else if constexpr (std::is_same_v<T, bool>) {
    out.set_bool_value(content);
  } else if constexpr (std::is_arithmetic_v<T>) {
    return JsonNumber(static_cast<double>(content));
  } else if constexpr (std::is_convertible_v<T, std::string_view>) {
    out.set_string_value(std::string(std::string_view(content)));
  } else {
    auto* list = out.mutable_list_value();
    for (const auto& one : content) *list->add_values() = JsonValue(one);
  }
  return out;
}

// A key with its value.
struct Json {
  template <typename T>
  Json(std::string name, const T& content) : key(std::move(name)), value(JsonValue(content)) {}

  std::string key;
  google::protobuf::Value value;
};

// Fills an object, which must outlive this.
class JsonObject {
 public:
  explicit JsonObject(google::protobuf::Value* value) : JsonObject(value->mutable_struct_value()) {}
  explicit JsonObject(google::protobuf::Struct* object) : fields_(object->mutable_fields()) {}

  // Set(Json("a", 1), Json("b", true)).
  template <typename... Entries>
  void Set(const Entries&... entries) {
    ((At(entries.key) = entries.value), ...);
  }
  google::protobuf::Value& At(const std::string& key) { return (*fields_)[key]; }
  JsonObject Object(const std::string& key) { return JsonObject(&At(key)); }

  // A list with an object for each item, filled by `fill(item, JsonObject)`.
  template <typename Items, typename Fill>
  void List(const std::string& key, const Items& items, Fill&& fill) {
    auto* list = At(key).mutable_list_value();
    for (const auto& item : items) fill(item, JsonObject(list->add_values()));
  }

 private:
  google::protobuf::Map<std::string, google::protobuf::Value>* fields_;
};

enum class JsonLayout { kOneLine, kIndented };

// The document with its keys in alphabetical order: the same document gives the same bytes.
// INTERNAL when the library rejects it.
absl::StatusOr<std::string> PrintDocument(const google::protobuf::Struct& document,
                                          JsonLayout layout);

}  // namespace graspdb::files
