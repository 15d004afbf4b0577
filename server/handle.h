// What every handler shares: errors become gRPC statuses, exceptions of libraries
// become errors, and each call leaves one line in the log.
#pragma once

#include <grpcpp/server_context.h>

#include <functional>
#include <string_view>

#include "absl/status/status.h"

namespace graspdb::server {

// Runs `work` for the call `method` and answers with its status.
grpc::Status Handle(const grpc::ServerContextBase& context, std::string_view method,
                    const std::function<absl::Status()>& work);

// Whether nobody waits for this call any more: it was cancelled or its deadline
// has passed.
bool IsAbandoned(const grpc::ServerContextBase& context);

}  // namespace graspdb::server
