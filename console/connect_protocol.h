// The Connect protocol (https://connectrpc.com/docs/protocol): what stands in its requests and
// responses. All functions are thread-safe.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"

namespace graspdb::console {

enum class Encoding { kJson, kBinary };

// How the body of a request is written; that of the response is the same.
struct BodyFormat {
  Encoding encoding = Encoding::kJson;
  bool is_stream = false;  // messages in envelopes
  friend bool operator==(const BodyFormat&, const BodyFormat&) = default;
};

// The value of the header Content-Type; parameters such as a charset are ignored. Absent for one
// that the protocol does not have.
std::optional<BodyFormat> ParseContentType(std::string_view value);
std::string_view ContentType(const BodyFormat& format);

// Of an error.
std::string_view CodeName(absl::StatusCode code);
int HttpStatus(absl::StatusCode code);

// An error as JSON: code, message, and the details of its payload client::kErrorDetails.
std::string ErrorJson(const absl::Status& error);

// A message of a stream. At most 4 GiB.
std::string Envelope(std::string_view message);
// The last one, with the error if there is one.
std::string EndOfStream(const absl::Status& status);

// The message in the body of a request that has one message in an envelope. INVALID_ARGUMENT for
// another body, UNIMPLEMENTED for a compressed message.
absl::StatusOr<std::string_view> OnlyMessage(std::string_view body);

// The value of the header Connect-Timeout-Ms: 1 to 10 digits. INVALID_ARGUMENT for another.
absl::StatusOr<absl::Duration> ParseTimeout(std::string_view value);

}  // namespace graspdb::console
