#include "server/requests/request_limits.h"

#include <google/protobuf/descriptor.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "server/base/errors.h"

namespace graspdb::server {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

// Applies to every field that is not in the table, so that a new one is bounded too.
constexpr int kMaxElements = 64;

struct LengthLimit {
  std::string_view field;  // its full name
  std::size_t bytes;
};
constexpr std::array<LengthLimit, 10> kLengths = {{
    {"graspdb.v1.Object.display_name", kMaxNameBytes},
    {"graspdb.v1.StablePose.display_name", kMaxNameBytes},
    {"graspdb.v1.Cell.display_name", kMaxNameBytes},
    // A resource name in base 64.
    {"graspdb.v1.ListObjectsRequest.page_token", 384},
    {"graspdb.v1.ListStablePosesRequest.page_token", 384},
    {"graspdb.v1.ListViewsRequest.page_token", 384},
    {"graspdb.v1.ListUploadsRequest.page_token", 384},
    {"graspdb.v1.ListUploadViewsRequest.page_token", 384},
    {"graspdb.v1.ListDeletedObjectsRequest.page_token", 384},
    {"graspdb.v1.ListObjectRevisionsRequest.page_token", 384},
}};

struct CountLimit {
  std::string_view field;
  int elements;
};
constexpr std::array<CountLimit, 5> kCounts = {{
    {"graspdb.v1.Object.labels", 32},
    {"graspdb.v1.Cell.labels", 32},
    {"graspdb.v1.StablePose.grasps", kMaxGrasps},
    {"graspdb.v1.StablePose.grasp_outcomes", kMaxGrasps},
    // Output only, but a client may send a view back as it got it.
    {"graspdb.v1.ViewDescriptor.bins", 1024},
}};

std::size_t MaxBytesOf(const FieldDescriptor& field) {
  const auto* found = std::ranges::find(kLengths, field.full_name(), &LengthLimit::field);
  return found == kLengths.end() ? kMaxStringBytes : found->bytes;
}

int MaxElementsOf(const FieldDescriptor& field) {
  const auto* found = std::ranges::find(kCounts, field.full_name(), &CountLimit::field);
  return found == kCounts.end() ? kMaxElements : found->elements;
}

absl::Status CheckBytes(std::size_t bytes, std::size_t max, std::string_view path) {
  if (bytes <= max) return absl::OkStatus();
  return InvalidField(path, absl::StrCat("has ", bytes, " bytes; send at most ", max));
}

absl::Status CheckMessage(const Message& message, const std::string& path);

// One value of a field: the only one where `index` is -1.
absl::Status CheckValue(const Message& message, const FieldDescriptor& field, int index,
                        const std::string& path) {
  const google::protobuf::Reflection& reader = *message.GetReflection();
  const bool repeated = index >= 0;
  if (field.type() == FieldDescriptor::TYPE_STRING) {
    std::string scratch;
    const std::string& text =
        repeated ? reader.GetRepeatedStringReference(message, &field, index, &scratch)
                 : reader.GetStringReference(message, &field, &scratch);
    return CheckBytes(text.size(), MaxBytesOf(field), path);
  }
  if (field.cpp_type() != FieldDescriptor::CPPTYPE_MESSAGE) return absl::OkStatus();
  return CheckMessage(repeated ? reader.GetRepeatedMessage(message, &field, index)
                               : reader.GetMessage(message, &field),
                      path);
}

absl::Status CheckField(const Message& message, const FieldDescriptor& field,
                        const std::string& path) {
  if (!field.is_repeated()) return CheckValue(message, field, -1, path);
  const int count = message.GetReflection()->FieldSize(message, &field);
  if (count > MaxElementsOf(field)) {
    return InvalidField(
        path, absl::StrCat("has ", count, " elements; send at most ", MaxElementsOf(field)));
  }
  for (int i = 0; i < count; ++i) {
    RETURN_IF_ERROR(CheckValue(message, field, i, absl::StrCat(path, "[", i, "]")));
  }
  return absl::OkStatus();
}

absl::Status CheckMessage(const Message& message, const std::string& path) {
  std::vector<const FieldDescriptor*> fields;
  message.GetReflection()->ListFields(message, &fields);
  for (const FieldDescriptor* field : fields) {
    const bool is_bounded = field->cpp_type() == FieldDescriptor::CPPTYPE_STRING ||
                            field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE ||
                            field->is_repeated();
    if (!is_bounded) continue;
    RETURN_IF_ERROR(
        CheckField(message, *field, absl::StrCat(path, path.empty() ? "" : ".", field->name())));
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status CheckLimits(const Message& request) { return CheckMessage(request, ""); }

absl::Status CheckLength(std::string_view text, std::string_view path) {
  return CheckBytes(text.size(), kMaxStringBytes, path);
}

}  // namespace graspdb::server
