#include "server/calls/handle.h"

#include <spdlog/spdlog.h>

#include <chrono>
#include <exception>
#include <new>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/time/time.h"
#include "base/status_macros.h"
#include "program/log/log_field.h"
#include "server/base/errors.h"
#include "server/calls/call_guard.h"
#include "server/requests/request_limits.h"
#include "storage/changes/change_author.h"

namespace graspdb::server {
namespace {

constexpr std::chrono::milliseconds kLookAgain{5};

absl::Status RunGuarded(const std::function<absl::Status()>& work) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError("the server has no memory left for this call");
  } catch (const std::exception& e) {
    return absl::InternalError(absl::StrCat("a library failed: ", e.what()));
  }
}

spdlog::level::level_enum LevelOf(std::string_view method, const absl::Status& status) {
  // How a client looks for an upload to go on with: nothing is wrong without one.
  if (method == "GetUpload" && absl::IsNotFound(status)) return spdlog::level::info;
  switch (status.code()) {
    case absl::StatusCode::kOk:
      return spdlog::level::info;
    case absl::StatusCode::kInternal:
    case absl::StatusCode::kDataLoss:
    case absl::StatusCode::kUnknown:
      return spdlog::level::err;
    default:
      return spdlog::level::warn;
  }
}

}  // namespace

bool IsAbandoned(const grpc::ServerContextBase& context) {
  return context.IsCancelled() || context.deadline() < std::chrono::system_clock::now();
}

bool AbandonedWatch::IsAbandoned() {
  const auto now = std::chrono::steady_clock::now();
  abandoned_ = abandoned_ || deadline_ < std::chrono::system_clock::now();
  if (abandoned_ || now < next_look_) return abandoned_;
  abandoned_ = context_.IsCancelled();
  next_look_ = now + kLookAgain;
  return abandoned_;
}

grpc::Status Handle(const grpc::ServerContextBase& context, std::string_view method,
                    const std::function<absl::Status()>& work) {
  const auto start = std::chrono::steady_clock::now();
  CallGuard* const guard = CallGuard::Of(context);
  absl::Status status =
      guard == nullptr ? absl::InternalError("the call has no guard") : guard->Authorize();
  if (status.ok()) {
    if (const absl::Status place = guard->TakePlace(); !place.ok()) {
      grpc::Status full = ToGrpcStatus(place);
      guard->RecordWithoutPlace(method, full);
      return full;
    }
    const storage::ChangeAuthor author({guard->identity(), std::string(method)});
    status = RunGuarded(work);
    // The handler takes it for the end of the client's messages.
    if (const absl::Status place = guard->CheckPlace(); !place.ok()) status = place;
  }
  if (absl::IsCancelled(status) && context.deadline() < std::chrono::system_clock::now()) {
    status = absl::DeadlineExceededError("the call's deadline passed before it was done");
  }
  const absl::Duration spent = absl::FromChrono(std::chrono::steady_clock::now() - start);
  grpc::Status answer = ToGrpcStatus(status);
  if (guard != nullptr) guard->Record(method, answer, spent);
  spdlog::log(LevelOf(method, status), "event=call method={} peer={} code={} ms={:.2f}{}{}", method,
              LogField(context.peer()), absl::StatusCodeToString(status.code()),
              absl::ToDoubleMilliseconds(spent), guard == nullptr ? "" : guard->TakeLogFields(),
              status.ok() ? "" : absl::StrCat(" error=", LogField(answer.error_message())));
  return answer;
}

grpc::Status Handle(const grpc::ServerContextBase& context, std::string_view method,
                    const google::protobuf::Message& request,
                    const std::function<absl::Status()>& work) {
  if (CallGuard* guard = CallGuard::Of(context)) guard->NoteRequest(request);
  return Handle(context, method, [&] {
    RETURN_IF_ERROR(CallGuard::Of(context)->AuthorizeRequest(request));
    RETURN_IF_ERROR(CheckLimits(request));
    return work();
  });
}

}  // namespace graspdb::server
