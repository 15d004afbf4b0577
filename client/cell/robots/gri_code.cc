#include "client/cell/robots/gri_code.h"

#include <array>
#include <string_view>
#include <utility>

namespace graspdb::client {
namespace {

constexpr std::array<std::pair<GriCode, std::string_view>, 23> kNames = {{
    {GriCode::kNoError, "NO_ERROR"},
    {GriCode::kUnknownError, "UNKNOWN_ERROR"},
    {GriCode::kInternalError, "INTERNAL_ERROR"},
    {GriCode::kApiNotReachable, "API_NOT_REACHABLE"},
    {GriCode::kApiResponseError, "API_RESPONSE_ERROR"},
    {GriCode::kPipelineNotAvailable, "PIPELINE_NOT_AVAILABLE"},
    {GriCode::kInvalidRequest, "INVALID_REQUEST_ERROR"},
    {GriCode::kInvalidRequestLength, "INVALID_REQUEST_LENGTH"},
    {GriCode::kInvalidAction, "INVALID_ACTION"},
    {GriCode::kProcessingTimeout, "PROCESSING_TIMEOUT"},
    {GriCode::kUnknownProtocolVersion, "UNKNOWN_PROTOCOL_VERSION"},
    {GriCode::kWrongProtocolForJob, "WRONG_PROTOCOL_FOR_JOB"},
    {GriCode::kJobDoesNotExist, "JOB_DOES_NOT_EXIST"},
    {GriCode::kMisconfiguredJob, "MISCONFIGURED_JOB"},
    {GriCode::kHecConfigError, "HEC_CONFIG_ERROR"},
    {GriCode::kHecInitError, "HEC_INIT_ERROR"},
    {GriCode::kHecSetPoseError, "HEC_SET_POSE_ERROR"},
    {GriCode::kHecCalibrateError, "HEC_CALIBRATE_ERROR"},
    {GriCode::kHecInsufficientDetection, "HEC_INSUFFICIENT_DETECTION"},
    {GriCode::kNoPosesFound, "NO_POSES_FOUND"},
    {GriCode::kNoRelatedPoses, "NO_RELATED_POSES"},
    {GriCode::kNoReturnSpecified, "NO_RETURN_SPECIFIED"},
    {GriCode::kJobStillRunning, "JOB_STILL_RUNNING"},
}};

}  // namespace

std::string GriCodeName(GriCode code) {
  for (const auto& [known, name] : kNames) {
    if (known == code) return std::string(name);
  }
  return "UNKNOWN_ERROR";
}

GriCode GriCodeOf(const absl::Status& status) {
  switch (status.code()) {
    case absl::StatusCode::kOk:
      return GriCode::kNoError;
    case absl::StatusCode::kNotFound:
      return GriCode::kJobDoesNotExist;
    case absl::StatusCode::kFailedPrecondition:
      return GriCode::kMisconfiguredJob;
    case absl::StatusCode::kPermissionDenied:
      return GriCode::kWrongProtocolForJob;
    case absl::StatusCode::kInvalidArgument:
      return GriCode::kInvalidRequest;
    case absl::StatusCode::kAborted:
      return GriCode::kPipelineNotAvailable;
    case absl::StatusCode::kUnavailable:
      return GriCode::kApiNotReachable;
    case absl::StatusCode::kDeadlineExceeded:
      return GriCode::kProcessingTimeout;
    case absl::StatusCode::kInternal:
      return GriCode::kInternalError;
    case absl::StatusCode::kUnknown:
      return GriCode::kUnknownError;
    default:
      return GriCode::kApiResponseError;
  }
}

}  // namespace graspdb::client
