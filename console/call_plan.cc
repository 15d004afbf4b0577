#include "console/call_plan.h"

#include <algorithm>
#include <string_view>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "console/methods.h"
#include "program/log/request_id.h"

namespace graspdb::console {
namespace {

constexpr std::size_t kMaxAuthorizationBytes = 2048;

// gRPC ends the process where a value has other characters.
bool IsMetadata(std::string_view text) {
  return text.size() <= kMaxAuthorizationBytes && std::ranges::all_of(text, absl::ascii_isprint);
}

absl::Status PlanMethod(std::string_view path, CallPlan* plan, int* http_status) {
  plan->method = FindMethod(path);
  if (plan->method == nullptr) {
    *http_status = 404;
    return absl::UnimplementedError("graspdb.v1 has no such method");
  }
  plan->request.path = path;
  // Of a stream of requests one goes to the server. More could end in a deadlock: the responses are
  // read after the requests were written.
  plan->request.is_stream = plan->method->server_streaming() || plan->method->client_streaming();
  return absl::OkStatus();
}

absl::Status PlanFormat(const RequestHead& head, CallPlan* plan, int* http_status) {
  const auto format = ParseContentType(Field(head, "Content-Type"));
  if (format) plan->format = *format;
  if (!format || format->is_stream != plan->request.is_stream) {
    *http_status = 415;
    plan->format.is_stream = false;
    return absl::InvalidArgumentError(absl::StrCat(
        plan->method->name(), " takes Content-Type ",
        plan->request.is_stream ? "application/connect+json or application/connect+proto"
                                : "application/json or application/proto"));
  }
  const std::string_view encoding =
      Field(head, plan->request.is_stream ? "Connect-Content-Encoding" : "Content-Encoding");
  if (!encoding.empty() && encoding != "identity") {
    return absl::UnimplementedError("compressed requests are not taken; supported is: identity");
  }
  const std::string_view version = Field(head, "Connect-Protocol-Version");
  if (!version.empty() && version != "1") {
    return absl::InvalidArgumentError("Connect-Protocol-Version is not 1");
  }
  return absl::OkStatus();
}

absl::Status PlanMetadata(const RequestHead& head, CallPlan* plan) {
  if (const std::string_view timeout = Field(head, "Connect-Timeout-Ms"); !timeout.empty()) {
    const absl::StatusOr<absl::Duration> parsed = ParseTimeout(timeout);
    if (!parsed.ok()) return parsed.status();
    plan->request.timeout = *parsed;
  }
  const std::string_view authorization = Field(head, "Authorization");
  if (!IsMetadata(authorization)) {
    return absl::InvalidArgumentError(
        "Authorization is not a text of at most 2048 ASCII characters");
  }
  plan->request.authorization = authorization;
  const std::string_view id = Field(head, kRequestIdKey);
  if (IsRequestId(id)) plan->request.request_id = id;
  return absl::OkStatus();
}

}  // namespace

absl::Status PlanCall(const RequestHead& head, CallPlan* plan, int* http_status) {
  absl::Status status = PlanMethod(Path(head), plan, http_status);
  if (!status.ok()) return status;
  status.Update(PlanFormat(head, plan, http_status));
  status.Update(PlanMetadata(head, plan));
  return status;
}

}  // namespace graspdb::console
