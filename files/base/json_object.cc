#include "files/base/json_object.h"

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <google/protobuf/util/json_util.h>
#include <google/protobuf/util/type_resolver_util.h>

#include <cmath>
#include <memory>

#include "absl/strings/str_cat.h"

namespace graspdb::files {
namespace {

// Sorts maps by their keys; the order of a hash table would differ from run to run.
std::string SortedBytes(const google::protobuf::Struct& document) {
  std::string bytes;
  google::protobuf::io::StringOutputStream stream(&bytes);
  google::protobuf::io::CodedOutputStream coded(&stream);
  coded.SetSerializationDeterministic(true);
  document.SerializeToCodedStream(&coded);
  coded.Trim();
  return bytes;
}

}  // namespace

google::protobuf::Value JsonNumber(double number) {
  google::protobuf::Value out;
  if (std::isfinite(number)) {
    out.set_number_value(number);
  } else {
    out.set_null_value(google::protobuf::NULL_VALUE);
  }
  return out;
}

absl::StatusOr<std::string> PrintDocument(const google::protobuf::Struct& document,
                                          JsonLayout layout) {
  constexpr char kPrefix[] = "type.googleapis.com";
  const std::unique_ptr<google::protobuf::util::TypeResolver> types(
      google::protobuf::util::NewTypeResolverForDescriptorPool(
          kPrefix, google::protobuf::DescriptorPool::generated_pool()));
  google::protobuf::util::JsonPrintOptions options;
  options.add_whitespace = layout == JsonLayout::kIndented;
  std::string text;
  const auto printed = google::protobuf::util::BinaryToJsonString(
      types.get(), absl::StrCat(kPrefix, "/google.protobuf.Struct"), SortedBytes(document), &text,
      options);
  if (printed.ok()) return text;
  return absl::InternalError(
      absl::StrCat("the report cannot be written as JSON: ", std::string(printed.message())));
}

}  // namespace graspdb::files
