// Common code of all handlers: refuses callers without the method's role, converts errors to gRPC
// statuses and exceptions of libraries to errors, and writes the log and the audit log.
#pragma once

#include <google/protobuf/message.h>
#include <grpcpp/server_context.h>

#include <chrono>
#include <functional>
#include <string_view>

#include "absl/status/status.h"

namespace graspdb::server {

// Runs `work` for the call `method` and returns its status; UNAUTHENTICATED or PERMISSION_DENIED
// instead if the caller may not make it (server/calls/call_guard.h), RESOURCE_EXHAUSTED if too many
// calls are in progress (server/calls/call_places.h).
grpc::Status Handle(const grpc::ServerContextBase& context, std::string_view method,
                    const std::function<absl::Status()>& work);

// The same for `request`, which must pass CheckLimits() first.
grpc::Status Handle(const grpc::ServerContextBase& context, std::string_view method,
                    const google::protobuf::Message& request,
                    const std::function<absl::Status()>& work);

// Whether no client waits for this call any more: it was cancelled or its deadline
// has passed.
bool IsAbandoned(const grpc::ServerContextBase& context);

// The same for work that checks often. The result for cancellation may be a few milliseconds old:
// gRPC polls the call's queue for it, which took 4 % of a frame's time. For one thread; `context`
// outlives it.
class AbandonedWatch {
 public:
  explicit AbandonedWatch(const grpc::ServerContextBase& context)
      : context_(context), deadline_(context.deadline()) {}
  bool IsAbandoned();

 private:
  const grpc::ServerContextBase& context_;
  const std::chrono::system_clock::time_point deadline_;
  bool abandoned_ = false;
  std::chrono::steady_clock::time_point next_look_;  // the first one is immediate
};

}  // namespace graspdb::server
