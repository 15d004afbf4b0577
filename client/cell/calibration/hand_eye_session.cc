#include "client/cell/calibration/hand_eye_session.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/time/time.h"
#include "base/status_macros.h"
#include "client/cell/calibration/calibrated_cell.h"
#include "files/messages/pose_message.h"
#include "program/base/monotonic_time.h"
#include "recognition/base/units.h"

namespace graspdb::client {
namespace {

using recognition::kDegreesPerRadian;
using recognition::kMmPerM;
using recognition::Pose;

// A sensor of 1 Hz delivers ten frames in it.
constexpr absl::Duration kFramesWithin = absl::Seconds(10);

absl::Status NotStarted() {
  return absl::AbortedError("the calibration was not started; send HEC_INIT first");
}

// INVALID_ARGUMENT would blame the robot's request, DATA_LOSS the camera.
absl::Status HideMisleading(const absl::Status& status) {
  const bool is_misleading = absl::IsInvalidArgument(status) || absl::IsDataLoss(status);
  return is_misleading ? absl::InternalError(status.message()) : status;
}

// Other codes would blame the server, the target or the robot's request.
absl::Status CameraFault(const absl::Status& status) {
  return absl::IsDeadlineExceeded(status) ? status : absl::DataLossError(status.message());
}

bool IsDepth(const Eigen::Vector3f& p) { return p.allFinite() && !p.isZero(0); }

absl::StatusOr<v1::Cell> ReadCell(Client& client, const HandEyeSetup& setup) {
  absl::StatusOr<v1::Cell> cell = client.GetCell(setup.cell);
  if (absl::IsNotFound(cell.status())) {
    return absl::FailedPreconditionError(
        absl::StrCat("there is no ", setup.cell, "; create it with `graspdb cells set`"));
  }
  if (!cell.ok()) return HideMisleading(cell.status());
  if (setup.mount == CameraMount::kFixed) {
    // Without the camera's sensor pose nothing could be saved.
    RETURN_IF_ERROR(CalibratedCell(*cell, {}, setup.mount).status());
  }
  return cell;
}

void LogResiduals(const std::map<int, HandEyeSample>& samples, const HandEye& hand_eye) {
  auto residual = hand_eye.residuals.begin();
  for (const auto& [slot, sample] : samples) {
    spdlog::info("event=hand_eye_residual slot={} shift_mm={:.2f} turn_deg={:.2f} used={}", slot,
                 kMmPerM * residual->shift_m, kDegreesPerRadian * residual->turn_rad,
                 residual->used);
    ++residual;
  }
}

}  // namespace

HandEyeSession::HandEyeSession(Client& client, DepthSensor& sensor, HandEyeSetup setup)
    : client_(client), sensor_(sensor), setup_(std::move(setup)) {}

absl::Status HandEyeSession::Init() {
  absl::MutexLock lock(&mutex_);
  target_.reset();
  samples_.clear();
  ASSIGN_OR_RETURN(const v1::Cell cell, ReadCell(client_, setup_));
  absl::StatusOr<Target> target = LoadTarget(client_, setup_.target);
  if (!target.ok()) return HideMisleading(target.status());
  if (setup_.mount == CameraMount::kFixed) world_sensor_ = files::FromMessage(cell.sensor_pose());
  target_ = *std::move(target);
  spdlog::info("event=hand_eye_begun cell={} target={}", setup_.cell, target_->stable_pose);
  return absl::OkStatus();
}

absl::StatusOr<DetectedTarget> HandEyeSession::DetectTarget() {
  const absl::StatusOr<StillScan> scan =
      TakeStillScan(sensor_, setup_.frames, MonotonicTime::Now() + kFramesWithin);
  if (!scan.ok()) return CameraFault(scan.status());
  if (std::ranges::none_of(scan->points, IsDepth)) {
    return absl::DataLossError(
        "the camera measures nothing, no pixel has a depth; is it covered, or too near?");
  }
  absl::StatusOr<DetectedTarget> found =
      setup_.mount == CameraMount::kFixed
          ? FindGrippedTarget(*target_, *scan, world_sensor_, setup_.region)
          : FindTargetOnTable(client_, *target_, *scan);
  if (!found.ok()) return HideMisleading(found.status());
  return found;
}

absl::Status HandEyeSession::SetPose(int slot, const Pose& base_flange) {
  absl::MutexLock lock(&mutex_);
  if (!target_) return NotStarted();
  ASSIGN_OR_RETURN(const DetectedTarget seen, DetectTarget());
  samples_[slot] = {base_flange, seen.sensor_target, seen.covariance};
  spdlog::info("event=hand_eye_pose cell={} slot={} distance_m={:.3f}", setup_.cell, slot,
               seen.sensor_target.translation().norm());
  return absl::OkStatus();
}

absl::StatusOr<CalibrationReport> HandEyeSession::Calibrate() {
  absl::MutexLock lock(&mutex_);
  if (!target_) return NotStarted();
  std::vector<HandEyeSample> samples;
  samples.reserve(samples_.size());
  for (const auto& [slot, sample] : samples_) samples.push_back(sample);
  const absl::StatusOr<HandEye> hand_eye = SolveHandEye(samples, setup_.mount);
  if (!hand_eye.ok()) return absl::NotFoundError(hand_eye.status().message());
  LogResiduals(samples_, *hand_eye);
  ASSIGN_OR_RETURN(const v1::Cell cell, ReadCell(client_, setup_));
  ASSIGN_OR_RETURN(const auto update, CalibratedCell(cell, *hand_eye, setup_.mount));
  const absl::StatusOr<v1::Cell> saved = client_.UpdateCell(update);
  if (!saved.ok()) return HideMisleading(saved.status());
  CalibrationReport out{.shift_m = hand_eye->shift_m,
                        .turn_rad = hand_eye->turn_rad,
                        .used = 0,
                        .poses = samples.size()};
  for (const HandEyeResidual& residual : hand_eye->residuals) out.used += residual.used ? 1 : 0;
  const HandEyeCertainty& certainty = hand_eye->certainty;
  spdlog::info(
      "event=hand_eye_calibrated cell={} used={} poses={} shift_mm={:.2f} turn_deg={:.2f} "
      "left_out_shift_mm={:.2f} left_out_turn_deg={:.2f} weakest_mm={:.2f}",
      setup_.cell, out.used, out.poses, kMmPerM * out.shift_m, kDegreesPerRadian * out.turn_rad,
      kMmPerM * certainty.left_out_shift_m, kDegreesPerRadian * certainty.left_out_turn_rad,
      kMmPerM * certainty.weakest_m);
  return out;
}

void CellCalibrator::Add(int pipeline, std::unique_ptr<HandEyeSession> session) {
  sessions_[pipeline] = std::move(session);
}

absl::StatusOr<HandEyeSession*> CellCalibrator::SessionOf(int pipeline) const {
  const auto found = sessions_.find(pipeline);
  if (found != sessions_.end()) return found->second.get();
  return absl::NotFoundError(
      absl::StrCat("there is no pipeline ", pipeline, " to calibrate; see the configuration"));
}

absl::Status CellCalibrator::Check(int pipeline) { return SessionOf(pipeline).status(); }

absl::Status CellCalibrator::Init(int pipeline) {
  ASSIGN_OR_RETURN(const auto session, SessionOf(pipeline));
  return session->Init();
}

absl::Status CellCalibrator::SetPose(int pipeline, int slot, const recognition::Pose& base_flange) {
  ASSIGN_OR_RETURN(const auto session, SessionOf(pipeline));
  return session->SetPose(slot, base_flange);
}

absl::StatusOr<CalibrationReport> CellCalibrator::Calibrate(int pipeline) {
  ASSIGN_OR_RETURN(const auto session, SessionOf(pipeline));
  return session->Calibrate();
}

}  // namespace graspdb::client
