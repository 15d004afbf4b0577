// The status codes for robots: those of the Generic Robot Interface, which the line protocol uses
// as well.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/status.h"

namespace graspdb::client {

// Negative: an error; positive: a warning.
enum class GriCode : std::int16_t {
  kNoError = 0,
  kUnknownError = -1,
  kInternalError = -2,
  kApiNotReachable = -3,
  kApiResponseError = -4,
  kPipelineNotAvailable = -5,
  kInvalidRequest = -6,
  kInvalidRequestLength = -7,
  kInvalidAction = -8,
  kProcessingTimeout = -9,
  kUnknownProtocolVersion = -10,
  kWrongProtocolForJob = -11,
  kJobDoesNotExist = -12,
  kMisconfiguredJob = -13,
  kHecConfigError = -14,
  kHecInitError = -15,
  kHecSetPoseError = -16,
  kHecCalibrateError = -17,
  kHecInsufficientDetection = -18,
  kNoPosesFound = 1,
  kNoRelatedPoses = 2,
  kNoReturnSpecified = 3,
  kJobStillRunning = 4,
};

enum class GriJobStatus : std::int32_t { kInactive = 1, kRunning = 2, kDone = 3, kFailed = 4 };

// The name in the interface's documentation, such as JOB_DOES_NOT_EXIST; UNKNOWN_ERROR for unknown
// numbers.
std::string GriCodeName(GriCode code);

// The code for an error of a JobRunner.
GriCode GriCodeOf(const absl::Status& status);

}  // namespace graspdb::client
