// Server errors as errors of JobRunner.
#pragma once

#include "absl/status/status.h"

namespace graspdb::client {

// Maps the status of a call to the server to JobRunner's errors: UNAVAILABLE and DEADLINE_EXCEEDED
// stay; RESOURCE_EXHAUSTED of a busy server (see BusyDelay) becomes UNAVAILABLE; every other error
// becomes DATA_LOSS, and its message starts with the server's code. Otherwise NOT_FOUND for a
// missing view would be taken for a missing job.
absl::Status Refusal(const absl::Status& answered);

}  // namespace graspdb::client
