#include "server/requests/request_names.h"

#include <google/protobuf/descriptor.h>

#include <string_view>

#include "absl/strings/str_cat.h"

namespace graspdb::server {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

constexpr std::string_view kIdSuffix = "_id";
constexpr std::string_view kCells = "cells/";

// A field that is one string; nullopt if there is none of that name, or an optional one is absent.
std::optional<std::string> Text(const Message& message, const std::string& name) {
  const FieldDescriptor* field = message.GetDescriptor()->FindFieldByName(name);
  if (field == nullptr || field->is_repeated() || field->type() != FieldDescriptor::TYPE_STRING) {
    return std::nullopt;
  }
  if (field->has_presence() && !message.GetReflection()->HasField(message, field)) {
    return std::nullopt;
  }
  return message.GetReflection()->GetString(message, field);
}

// The `name` in the message of the field.
std::optional<std::string> NameIn(const Message& message, const FieldDescriptor& field) {
  if (field.is_repeated() || field.cpp_type() != FieldDescriptor::CPPTYPE_MESSAGE) {
    return std::nullopt;
  }
  return Text(message.GetReflection()->GetMessage(message, &field), "name");
}

// "{parent}/stablePoses/{id}" of a request with `parent`, `stable_pose_id` and `stable_pose`.
std::optional<std::string> CreatedName(const Message& request) {
  for (int i = 0; i < request.GetDescriptor()->field_count(); ++i) {
    const std::string& field = request.GetDescriptor()->field(i)->name();
    if (!field.ends_with(kIdSuffix)) continue;
    const std::string kind = field.substr(0, field.size() - kIdSuffix.size());
    const FieldDescriptor* resource = request.GetDescriptor()->FindFieldByName(kind);
    const std::optional<std::string> id = Text(request, field);
    if (resource == nullptr || !id) continue;
    const std::string parent = Text(request, "parent").value_or("");
    return absl::StrCat(parent, parent.empty() ? "" : "/", resource->camelcase_name(), "s/", *id);
  }
  return std::nullopt;
}

std::optional<std::string> NameOfUpdated(const Message& request) {
  for (int i = 0; i < request.GetDescriptor()->field_count(); ++i) {
    if (auto name = NameIn(request, *request.GetDescriptor()->field(i))) return name;
  }
  return std::nullopt;
}

}  // namespace

std::string ResourceOf(const Message& request) {
  if (auto name = Text(request, "name")) return *name;
  if (auto name = CreatedName(request)) return *name;
  if (auto name = NameOfUpdated(request)) return *name;
  for (const char* field : {"parent", "object", "cell"}) {
    if (auto name = Text(request, field)) return *name;
  }
  return "";
}

std::optional<std::string> CellOf(const Message& request) {
  if (auto cell = Text(request, "cell")) return cell;
  const std::string name = ResourceOf(request);
  if (name.starts_with(kCells)) return name;
  return std::nullopt;
}

}  // namespace graspdb::server
