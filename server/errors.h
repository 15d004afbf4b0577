// Errors on their way to the caller.
#pragma once

#include <grpcpp/support/status.h>

#include <string_view>

#include "absl/status/status.h"

namespace graspdb::server {

// INVALID_ARGUMENT for a field of the request: "path: description", with a
// google.rpc.BadRequest attached.
absl::Status InvalidField(std::string_view path, std::string_view description);

// An INVALID_ARGUMENT that names no field yet, as that of `path`; other statuses as
// they are.
absl::Status AtField(std::string_view path, const absl::Status& status);

// `status` with a google.rpc.ErrorInfo attached: `reason` in UPPER_SNAKE_CASE.
absl::Status WithReason(absl::Status status, std::string_view reason);

// The one map from our errors to gRPC's: the same code, the message, and a
// google.rpc.Status with the attached details and always an ErrorInfo (AIP-193).
grpc::Status ToGrpcStatus(const absl::Status& status);

}  // namespace graspdb::server
