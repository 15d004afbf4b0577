// The hand-eye calibration actions of the Generic Robot Interface.
#pragma once

#include <map>
#include <mutex>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "client/cell/robots/gri/gri_message.h"
#include "client/cell/robots/robot_calibrator.h"

namespace graspdb::client {

// The last slot: the documentation has 0 to 7, robot programs send 1 to 8.
inline constexpr int kLastHecSlot = 8;

// Answers HEC_INIT, HEC_SET_POSE and HEC_CALIBRATE; data_1 of the request is the pipeline, data_2
// of HEC_SET_POSE the slot. The answer to HEC_CALIBRATE has the root mean square residuals: data_2
// the shift in 10^-6 mm, data_3 the turn in 10^-6 degrees, data_4 the number of poses used. Error
// messages are logged. A request for a pipeline whose last one is still being answered is an error:
// those of a robot that does not wait would otherwise occupy all workers. Thread-safe.
class GriHandEye {
 public:
  // `calibrator` must outlive this; null: no pipelines.
  explicit GriHandEye(RobotCalibrator* calibrator) : calibrator_(calibrator) {}

  // The header must have been checked.
  GriResponse Answer(const GriRequest& request) ABSL_LOCKS_EXCLUDED(mutex_);

 private:
  absl::Status DoAlone(const GriRequest& request, GriResponse* out) ABSL_LOCKS_EXCLUDED(mutex_);
  absl::Status Do(const GriRequest& request, GriResponse* out);

  RobotCalibrator* calibrator_;
  absl::Mutex mutex_;
  std::map<int, std::mutex> turns_ ABSL_GUARDED_BY(mutex_);  // by pipeline; held by its request
};

}  // namespace graspdb::client
