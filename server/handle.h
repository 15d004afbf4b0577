// What every handler shares: errors become gRPC statuses, exceptions of libraries
// become errors, and each call leaves one line in the log.
#pragma once

#include <google/protobuf/message.h>
#include <grpcpp/server_context.h>

#include <chrono>
#include <functional>
#include <string_view>

#include "absl/status/status.h"

namespace graspdb::server {

// Runs `work` for the call `method` and answers with its status.
grpc::Status Handle(const grpc::ServerContextBase& context, std::string_view method,
                    const std::function<absl::Status()>& work);

// The same for `request`, which CheckLimits() must let through first.
grpc::Status Handle(const grpc::ServerContextBase& context, std::string_view method,
                    const google::protobuf::Message& request,
                    const std::function<absl::Status()>& work);

// Whether nobody waits for this call any more: it was cancelled or its deadline
// has passed.
bool IsAbandoned(const grpc::ServerContextBase& context);

// The same for work that asks again and again. Whether the call was cancelled is what it was a few
// milliseconds ago: gRPC polls the call's queue to say it, which took 4 % of a frame's time. For
// one thread; `context` outlives it.
class AbandonedWatch {
 public:
  explicit AbandonedWatch(const grpc::ServerContextBase& context)
      : context_(context), deadline_(context.deadline()) {}
  bool IsAbandoned();

 private:
  const grpc::ServerContextBase& context_;
  const std::chrono::system_clock::time_point deadline_;
  bool abandoned_ = false;
  std::chrono::steady_clock::time_point next_look_;  // the first one is at once
};

}  // namespace graspdb::server
