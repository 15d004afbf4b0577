#include "server/base/errors.h"

#include "absl/strings/cord.h"
#include "absl/strings/str_cat.h"
#include "google/rpc/error_details.pb.h"
#include "program/text/printable_text.h"

namespace graspdb::server {
namespace {

// In a tenth of a second one or two frames are processed.
constexpr std::int32_t kRetryDelayNs = 100'000'000;
constexpr std::string_view kDomain = "graspdb";
constexpr std::string_view kTypePrefix = "type.googleapis.com/";

template <typename Message>
std::string TypeUrl() {
  return absl::StrCat(std::string(kTypePrefix), Message::descriptor()->full_name());
}

template <typename Message>
void Attach(const Message& detail, absl::Status* status) {
  status->SetPayload(TypeUrl<Message>(), absl::Cord(detail.SerializeAsString()));
}

// Adds the detail of that type, unless it would not fit.
void AddDetail(const std::string& type_url, const absl::Status& status,
               google::rpc::Status* details) {
  auto* any = details->add_details();
  any->set_type_url(type_url);
  any->set_value(std::string(*status.GetPayload(type_url)));
  if (details->ByteSizeLong() > kMaxDetailBytes) details->mutable_details()->RemoveLast();
}

constexpr std::string_view kCut = "...";

}  // namespace

absl::Status InvalidField(std::string_view path, std::string_view description) {
  const std::string field = BoundedText(path, kMaxPathBytes);
  const std::string text = BoundedText(description, kMaxMessageBytes);
  absl::Status status = absl::InvalidArgumentError(absl::StrCat(field, ": ", text));
  google::rpc::BadRequest detail;
  auto* violation = detail.add_field_violations();
  violation->set_field(field);
  violation->set_description(text);
  Attach(detail, &status);
  return status;
}

std::string FieldPath(std::string_view path, std::string_view field) {
  return absl::StrCat(std::string(path), ".", std::string(field));
}

absl::Status AtField(std::string_view path, const absl::Status& status) {
  const bool needs_field =
      absl::IsInvalidArgument(status) && !status.GetPayload(TypeUrl<google::rpc::BadRequest>());
  return needs_field ? InvalidField(path, std::string(status.message())) : status;
}

absl::Status TryAgainLater(absl::Status status) {
  google::rpc::RetryInfo info;
  info.mutable_retry_delay()->set_nanos(kRetryDelayNs);
  Attach(info, &status);
  return status;
}

absl::Status WithReason(absl::Status status, std::string_view reason) {
  google::rpc::ErrorInfo info;
  info.set_reason(BoundedText(reason, kMaxPathBytes));
  info.set_domain(std::string(kDomain));
  Attach(info, &status);
  return status;
}

google::rpc::Status ToRpcStatus(const absl::Status& status) {
  google::rpc::Status details;
  if (status.ok()) return details;
  absl::Status complete = status;
  if (!complete.GetPayload(TypeUrl<google::rpc::ErrorInfo>())) {
    complete = WithReason(complete, absl::StatusCodeToString(complete.code()));
  }
  details.set_code(static_cast<int>(complete.code()));
  details.set_message(BoundedText(std::string(complete.message()), kMaxMessageBytes));
  AddDetail(TypeUrl<google::rpc::ErrorInfo>(), complete, &details);
  complete.ForEachPayload([&](absl::string_view type_url, const absl::Cord& /*payload*/) {
    if (type_url != TypeUrl<google::rpc::ErrorInfo>()) {
      AddDetail(std::string(type_url), complete, &details);
    }
  });
  return details;
}

grpc::Status ToGrpcStatus(const absl::Status& status) {
  if (status.ok()) return grpc::Status::OK;
  const google::rpc::Status details = ToRpcStatus(status);
  return {static_cast<grpc::StatusCode>(details.code()), details.message(),
          details.SerializeAsString()};
}

std::string BoundedText(std::string_view text, std::size_t max_bytes) {
  std::string out;
  std::size_t cut_at = 0;  // where the mark of a cut still fits
  while (!text.empty()) {
    const std::size_t length = LengthOfCharacter(text);
    const std::string_view character = length == 0 ? "?" : text.substr(0, length);
    if (out.size() + character.size() > max_bytes) {
      out.resize(cut_at);
      out += kCut;
      return out;
    }
    out += character;
    if (out.size() + kCut.size() <= max_bytes) cut_at = out.size();
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return out;
}

}  // namespace graspdb::server
