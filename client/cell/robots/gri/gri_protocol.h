// The Generic Robot Interface for RobotServer.
#pragma once

#include <map>
#include <mutex>
#include <string>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "client/cell/robots/gri/gri_message.h"
#include "client/cell/robots/job_runner.h"
#include "client/cell/robots/robot_server.h"
#include "client/cell/robots/robot_session.h"

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

// Answers STATUS, TRIGGER_JOB_SYNC, TRIGGER_JOB_ASYNC, GET_JOB_STATUS, GET_NEXT_POSE and
// GET_RELATED_POSE. Thread-safe.
class GriJobs {
 public:
  // `runner` must outlive this. The destructor waits for running jobs.
  explicit GriJobs(JobRunner& runner) : jobs_(runner) {}

  // `robot` identifies the sender, e.g. by its address. The header must have been checked.
  GriResponse Answer(const std::string& robot, const GriRequest& request);

 private:
  void AnswerJob(const std::string& robot, const GriRequest& request, GriResponse* response);

  RobotJobs jobs_;
};

// Every message gets an answer of 80 bytes. Foreign bytes and wrong lengths close the connection,
// because the start of the next message is unknown.
class GriProtocol : public RobotProtocol {
 public:
  // `jobs` and `calibrator` must outlive this; null: no pipeline can be calibrated.
  explicit GriProtocol(GriJobs& jobs, RobotCalibrator* calibrator = nullptr)
      : jobs_(jobs), hand_eye_(calibrator) {}

  std::size_t MessageBytes(std::string_view received) const override;
  RobotReply Answer(const std::string& robot, std::string_view message) override;

 private:
  GriResponse Dispatch(const std::string& robot, const GriRequest& request);

  GriJobs& jobs_;
  GriHandEye hand_eye_;
};

}  // namespace graspdb::client
