#include "client/cell/calibration/cell_calibrator.h"

#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"

namespace graspdb::client {

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
