// What a server refuses, among the errors of JobRunner.
#pragma once

#include "absl/status/status.h"

namespace graspdb::client {

// The status of a call to the server, as JobRunner has it: UNAVAILABLE, DEADLINE_EXCEEDED and
// RESOURCE_EXHAUSTED stay; every other error becomes DATA_LOSS, and its message begins with the
// server's code. Without this a view that the server does not find would be a job that does not
// exist.
absl::Status Refusal(const absl::Status& answered);

}  // namespace graspdb::client
