// Errors in responses.
//
// They are sent as HTTP/2 trailers, which gRPC limits to 8 KiB in total; the text once
// percent-encoded (up to three bytes for one) and once in base 64. Longer ones reach the caller as
// RESOURCE_EXHAUSTED of the transport, without code and details. So every text is cut here.
#pragma once

#include <grpcpp/support/status.h>

#include <cstddef>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "google/rpc/status.pb.h"

namespace graspdb::server {

// INVALID_ARGUMENT for a field of the request: "path: description", with a
// google.rpc.BadRequest attached.
absl::Status InvalidField(std::string_view path, std::string_view description);

// "path.field".
std::string FieldPath(std::string_view path, std::string_view field);

// Adds the field `path` to an INVALID_ARGUMENT without a field; other statuses are
// returned unchanged.
absl::Status AtField(std::string_view path, const absl::Status& status);

// Adds a google.rpc.RetryInfo: a retry may succeed a little later.
absl::Status TryAgainLater(absl::Status status);

// `status` with a google.rpc.ErrorInfo attached: `reason` in UPPER_SNAKE_CASE.
absl::Status WithReason(absl::Status status, std::string_view reason);

// Bytes of an error's text and of a field violation's description; twice as many would not fit.
inline constexpr std::size_t kMaxMessageBytes = 768;
// Bytes of a field's path and of a reason.
inline constexpr std::size_t kMaxPathBytes = 256;
// Bytes of a google.rpc.Status in total; further details are left out.
inline constexpr std::size_t kMaxDetailBytes = 2560;

// Converts our errors to gRPC's: the same code, the message, and a google.rpc.Status with the
// attached details and always an ErrorInfo (AIP-193). The text is valid UTF-8 of at most
// kMaxMessageBytes.
grpc::Status ToGrpcStatus(const absl::Status& status);

// The same as a message, for errors inside of a response.
google::rpc::Status ToRpcStatus(const absl::Status& status);

// `text` as valid UTF-8 of at most `max_bytes` (at least 3): invalid UTF-8 becomes '?', and longer
// text is cut between two characters and ends in "...". Reads no more than `max_bytes` and one
// character of it.
std::string BoundedText(std::string_view text, std::size_t max_bytes);

}  // namespace graspdb::server
