#include "server/errors.h"

#include "absl/strings/cord.h"
#include "absl/strings/str_cat.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"

namespace graspdb::server {
namespace {

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

}  // namespace

absl::Status InvalidField(std::string_view path, std::string_view description) {
  absl::Status status =
      absl::InvalidArgumentError(absl::StrCat(std::string(path), ": ", std::string(description)));
  google::rpc::BadRequest detail;
  auto* violation = detail.add_field_violations();
  violation->set_field(std::string(path));
  violation->set_description(std::string(description));
  Attach(detail, &status);
  return status;
}

absl::Status AtField(std::string_view path, const absl::Status& status) {
  const bool needs_field =
      absl::IsInvalidArgument(status) && !status.GetPayload(TypeUrl<google::rpc::BadRequest>());
  return needs_field ? InvalidField(path, std::string(status.message())) : status;
}

absl::Status WithReason(absl::Status status, std::string_view reason) {
  google::rpc::ErrorInfo info;
  info.set_reason(std::string(reason));
  info.set_domain(std::string(kDomain));
  Attach(info, &status);
  return status;
}

grpc::Status ToGrpcStatus(const absl::Status& status) {
  if (status.ok()) return grpc::Status::OK;
  absl::Status complete = status;
  if (!complete.GetPayload(TypeUrl<google::rpc::ErrorInfo>())) {
    complete = WithReason(complete, absl::StatusCodeToString(complete.code()));
  }
  google::rpc::Status details;
  details.set_code(static_cast<int>(complete.code()));
  details.set_message(std::string(complete.message()));
  complete.ForEachPayload([&](absl::string_view type_url, const absl::Cord& payload) {
    auto* any = details.add_details();
    any->set_type_url(std::string(type_url));
    any->set_value(std::string(payload));
  });
  return {static_cast<grpc::StatusCode>(complete.code()), std::string(complete.message()),
          details.SerializeAsString()};
}

}  // namespace graspdb::server
