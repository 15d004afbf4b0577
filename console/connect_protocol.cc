#include "console/connect_protocol.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>
#include <google/protobuf/struct.pb.h>
#include <google/protobuf/util/json_util.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/cord.h"
#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "client/sdk/client.h"
#include "files/base/json_object.h"
#include "google/rpc/status.pb.h"
#include "program/text/printable_text.h"

namespace graspdb::console {
namespace {

using google::protobuf::Struct;
using google::protobuf::Value;

struct Code {
  absl::StatusCode code;
  std::string_view name;
  int http_status;
};

constexpr std::array<Code, 16> kCodes = {{
    {absl::StatusCode::kCancelled, "canceled", 499},
    {absl::StatusCode::kUnknown, "unknown", 500},
    {absl::StatusCode::kInvalidArgument, "invalid_argument", 400},
    {absl::StatusCode::kDeadlineExceeded, "deadline_exceeded", 504},
    {absl::StatusCode::kNotFound, "not_found", 404},
    {absl::StatusCode::kAlreadyExists, "already_exists", 409},
    {absl::StatusCode::kPermissionDenied, "permission_denied", 403},
    {absl::StatusCode::kResourceExhausted, "resource_exhausted", 429},
    {absl::StatusCode::kFailedPrecondition, "failed_precondition", 400},
    {absl::StatusCode::kAborted, "aborted", 409},
    {absl::StatusCode::kOutOfRange, "out_of_range", 400},
    {absl::StatusCode::kUnimplemented, "unimplemented", 501},
    {absl::StatusCode::kInternal, "internal", 500},
    {absl::StatusCode::kUnavailable, "unavailable", 503},
    {absl::StatusCode::kDataLoss, "data_loss", 500},
    {absl::StatusCode::kUnauthenticated, "unauthenticated", 401},
}};

const Code& RowOf(absl::StatusCode code) {
  const auto* row = std::ranges::find(kCodes, code, &Code::code);
  return row != kCodes.end() ? *row : kCodes[1];
}

struct Format {
  std::string_view name;
  BodyFormat format;
};

constexpr std::array<Format, 4> kFormats = {{
    {"application/json", {Encoding::kJson, false}},
    {"application/proto", {Encoding::kBinary, false}},
    {"application/connect+json", {Encoding::kJson, true}},
    {"application/connect+proto", {Encoding::kBinary, true}},
}};

constexpr std::size_t kEnvelopeBytes = 5;  // flags, and the length, big-endian
constexpr char kCompressed = 1;
constexpr char kEndOfStream = 2;
constexpr std::size_t kMaxTimeoutDigits = 10;

std::string Enclose(char flags, std::string_view message) {
  const auto size = static_cast<std::uint32_t>(message.size());
  std::string out = {flags, static_cast<char>(size >> 24), static_cast<char>(size >> 16),
                     static_cast<char>(size >> 8), static_cast<char>(size)};
  out += message;
  return out;
}

// Texts of errors may have names of files, in any encoding.
std::string Utf8(std::string_view text) {
  const std::vector<std::string> lines =
      absl::StrSplit(absl::string_view(text.data(), text.size()), '\n');
  return absl::StrJoin(
      lines, "\n", [](std::string* out, const std::string& line) { *out += PrintableText(line); });
}

// The detail as JSON, for readers of the response; absent for a type that is not linked.
std::optional<Value> DebugText(const google::protobuf::Any& detail) {
  const std::size_t slash = detail.type_url().rfind('/');
  const google::protobuf::Descriptor* type =
      google::protobuf::DescriptorPool::generated_pool()->FindMessageTypeByName(
          detail.type_url().substr(slash + 1));
  if (type == nullptr) return std::nullopt;
  const std::unique_ptr<google::protobuf::Message> message(
      google::protobuf::MessageFactory::generated_factory()->GetPrototype(type)->New());
  std::string json;
  Struct out;
  if (!message->ParseFromString(detail.value()) ||
      !google::protobuf::util::MessageToJsonString(*message, &json).ok() ||
      !google::protobuf::util::JsonStringToMessage(json, &out).ok()) {
    return std::nullopt;
  }
  Value value;
  *value.mutable_struct_value() = std::move(out);
  return value;
}

Struct DetailMessage(const google::protobuf::Any& detail) {
  Struct out;
  const std::size_t slash = detail.type_url().rfind('/');
  (*out.mutable_fields())["type"].set_string_value(Utf8(detail.type_url().substr(slash + 1)));
  std::string bytes = absl::Base64Escape(detail.value());
  while (absl::EndsWith(bytes, "=")) bytes.pop_back();  // the protocol has no padding
  (*out.mutable_fields())["value"].set_string_value(bytes);
  if (std::optional<Value> debug = DebugText(detail)) {
    (*out.mutable_fields())["debug"] = *std::move(debug);
  }
  return out;
}

Struct ErrorMessage(const absl::Status& error) {
  Struct out;
  (*out.mutable_fields())["code"].set_string_value(std::string(CodeName(error.code())));
  (*out.mutable_fields())["message"].set_string_value(
      Utf8({error.message().data(), error.message().size()}));
  google::rpc::Status details;
  const auto payload = error.GetPayload(client::kErrorDetails);
  if (!payload || !details.ParseFromString(std::string(*payload))) return out;
  for (const google::protobuf::Any& detail : details.details()) {
    *(*out.mutable_fields())["details"].mutable_list_value()->add_values()->mutable_struct_value() =
        DetailMessage(detail);
  }
  return out;
}

// With the keys in alphabetical order.
std::string Print(const Struct& document) {
  return files::PrintDocument(document, files::JsonLayout::kOneLine).value_or("{}");
}

}  // namespace

std::optional<BodyFormat> ParseContentType(std::string_view value) {
  const std::string_view type = value.substr(0, value.find(';'));
  const std::string name =
      absl::AsciiStrToLower(absl::StripAsciiWhitespace({type.data(), type.size()}));
  const auto* found = std::ranges::find(kFormats, name, &Format::name);
  if (found == kFormats.end()) return std::nullopt;
  return found->format;
}

std::string_view ContentType(const BodyFormat& format) {
  return std::ranges::find(kFormats, format, &Format::format)->name;
}

std::string_view CodeName(absl::StatusCode code) { return RowOf(code).name; }

int HttpStatus(absl::StatusCode code) { return RowOf(code).http_status; }

std::string ErrorJson(const absl::Status& error) { return Print(ErrorMessage(error)); }

std::string Envelope(std::string_view message) { return Enclose(0, message); }

std::string EndOfStream(const absl::Status& status) {
  Struct out;
  if (!status.ok()) {
    *(*out.mutable_fields())["error"].mutable_struct_value() = ErrorMessage(status);
  }
  return Enclose(kEndOfStream, Print(out));
}

absl::StatusOr<std::string_view> OnlyMessage(std::string_view body) {
  if (body.size() < kEnvelopeBytes) {
    return absl::InvalidArgumentError(
        "the body has no message; send one in an envelope: a byte 0, its length as four bytes "
        "(big-endian), and its bytes");
  }
  std::uint32_t size = 0;
  for (std::size_t i = 1; i < kEnvelopeBytes; ++i) {
    size = size << 8 | static_cast<unsigned char>(body[i]);
  }
  if (body[0] == kCompressed) {
    return absl::UnimplementedError("the message is compressed; send it as it is");
  }
  if (body[0] != 0 || body.size() - kEnvelopeBytes != size) {
    return absl::InvalidArgumentError(
        "the body is not one message in an envelope; a stream of more requests takes gRPC");
  }
  return body.substr(kEnvelopeBytes);
}

absl::StatusOr<absl::Duration> ParseTimeout(std::string_view value) {
  std::int64_t milliseconds = 0;
  if (value.empty() || value.size() > kMaxTimeoutDigits ||
      !std::ranges::all_of(value, absl::ascii_isdigit) ||
      !absl::SimpleAtoi(absl::string_view(value.data(), value.size()), &milliseconds)) {
    return absl::InvalidArgumentError(
        "Connect-Timeout-Ms is not a number of milliseconds with 1 to 10 digits");
  }
  return absl::Milliseconds(milliseconds);
}

}  // namespace graspdb::console
