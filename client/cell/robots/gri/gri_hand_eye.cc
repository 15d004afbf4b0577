#include "client/cell/robots/gri/gri_hand_eye.h"

#include <spdlog/spdlog.h>

#include <numbers>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "program/log/log_field.h"

namespace graspdb::client {
namespace {

constexpr double kMillionthsOfMmPerM = 1e9;
constexpr double kMillionthsOfDegreePerRadian = 1e6 * 180 / std::numbers::pi;

GriCode CodeOfAction(GriAction action) {
  switch (action) {
    case GriAction::kHecInit:
      return GriCode::kHecInitError;
    case GriAction::kHecSetPose:
      return GriCode::kHecSetPoseError;
    default:
      return GriCode::kHecCalibrateError;
  }
}

// The code for an error of a RobotCalibrator; the action's own code where none is more specific.
GriCode HecCodeOf(const absl::Status& status, GriAction action) {
  switch (status.code()) {
    case absl::StatusCode::kOk:
      return GriCode::kNoError;
    case absl::StatusCode::kNotFound:
      return GriCode::kHecInsufficientDetection;
    case absl::StatusCode::kFailedPrecondition:
      return GriCode::kHecConfigError;
    case absl::StatusCode::kInvalidArgument:
      return GriCode::kInvalidRequest;
    case absl::StatusCode::kUnavailable:
      return GriCode::kApiNotReachable;
    case absl::StatusCode::kDataLoss:
      return GriCode::kPipelineNotAvailable;
    case absl::StatusCode::kDeadlineExceeded:
      return GriCode::kProcessingTimeout;
    default:
      return CodeOfAction(action);
  }
}

}  // namespace

absl::Status GriHandEye::Do(const GriRequest& request, GriResponse* out) {
  const int pipeline = request.data[0];
  const auto action = static_cast<GriAction>(request.action);
  if (action == GriAction::kHecInit) return calibrator_->Init(pipeline);
  if (action == GriAction::kHecSetPose) {
    const int slot = request.data[1];
    if (slot < 0 || slot > kLastHecSlot) {
      return absl::InvalidArgumentError(
          absl::StrCat("there is no slot ", slot, "; slots are 0 to ", kLastHecSlot));
    }
    ASSIGN_OR_RETURN(const auto base_flange, RobotPoseOf(request));
    return calibrator_->SetPose(pipeline, slot, base_flange);
  }
  ASSIGN_OR_RETURN(const CalibrationReport report, calibrator_->Calibrate(pipeline));
  out->data[gri_data::kShift] = Saturated(report.shift_m * kMillionthsOfMmPerM);
  out->data[gri_data::kTurn] = Saturated(report.turn_rad * kMillionthsOfDegreePerRadian);
  out->data[gri_data::kUsed] = static_cast<std::int32_t>(report.used);
  return absl::OkStatus();
}

absl::Status GriHandEye::DoAlone(const GriRequest& request, GriResponse* out) {
  std::mutex* turn = nullptr;
  {
    const absl::MutexLock lock(&mutex_);
    turn = &turns_[request.data[0]];  // stays where it is
  }
  const std::unique_lock alone(*turn, std::try_to_lock);
  if (alone) return Do(request, out);
  return absl::AbortedError("the pipeline's last request is still being answered; wait for it");
}

GriResponse GriHandEye::Answer(const GriRequest& request) {
  GriResponse out = ResponseTo(request);
  const int pipeline = request.data[0];
  if (calibrator_ == nullptr || !calibrator_->Check(pipeline).ok()) {
    spdlog::warn("event=no_calibration_pipeline pipeline={}", pipeline);
    out.code = GriCode::kPipelineNotAvailable;
    return out;
  }
  const absl::Status status = DoAlone(request, &out);
  out.code = HecCodeOf(status, static_cast<GriAction>(request.action));
  if (!status.ok()) {
    spdlog::warn("event=calibration_failed pipeline={} code={} error={}", pipeline,
                 static_cast<int>(out.code), LogField(std::string(status.message())));
  }
  return out;
}

}  // namespace graspdb::client
