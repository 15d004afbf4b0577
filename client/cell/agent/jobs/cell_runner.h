// Runs the jobs of a cell.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "client/cell/agent/jobs/capture_and_recognize.h"
#include "client/cell/agent/jobs/cell_cache.h"
#include "client/cell/agent/jobs/job_answer.h"
#include "client/cell/agent/settings/job_config.h"
#include "client/cell/robots/job_runner.h"
#include "graspdb/v1/bundle.pb.h"
#include "program/base/monotonic_time.h"

namespace graspdb::client {

class CellMetrics;
class Counters;

struct CellRunnerOptions {
  absl::Duration time_limit = absl::Seconds(5);  // of jobs without one of their own
  Reach reach = {};                              // its workspace is set from the cell
};

// The result of a recognising job; its request refers to the session during the callback only.
struct JobReport {
  JobRequest request;
  absl::Time start;  // by the wall clock
  absl::Duration duration = absl::ZeroDuration();
  absl::Status status = absl::OkStatus();
  CaptureResult capture = {};  // on errors, as far as filled in
  std::vector<JobPose> poses = {};
  std::string no_pose_reason = {};  // see NoPoseReason; empty on errors
};
using JobCallback = std::function<void(const JobReport& report)>;

// Dependencies of a CellRunner, which all must outlive it. `on_job` may be empty, and is called on
// the robot's thread.
struct CellParts {
  DepthSensor& sensor;
  Client& client;
  CellCache& cell;
  CaptureAndRecognize& capture_and_recognize;
  Counters& counters;
  std::string name;  // of the cell, a resource name
  JobCallback on_job = {};
  CellMetrics* metrics = nullptr;  // null: none
};

// Runs the jobs of a cell for robots of one protocol. Thread-safe.
class CellRunner : public JobRunner {
 public:
  CellRunner(Jobs jobs, JobProtocol protocol, CellRunnerOptions options, CellParts parts);

  bool IsReady() override;
  absl::Status Check(int job) override;
  absl::StatusOr<std::vector<JobPose>> Run(const JobRequest& request) override;
  bool ReturnsPoses(int job) override;
  absl::Status ReportOutcome(RobotSession& session, PickOutcome outcome) override;

 private:
  absl::StatusOr<std::vector<JobPose>> Recognize(const JobConfig& job, const JobRequest& request);
  // Sets the poses of the report's capture, or the reason why there is none.
  absl::Status FindPoses(const JobConfig& job, JobReport* report);
  absl::Status Show(const JobConfig& job, const JobRequest& request);
  MonotonicTime DeadlineOf(const JobConfig& job) const;

  const Jobs jobs_;
  const JobProtocol protocol_;
  const CellRunnerOptions options_;
  const CellParts parts_;
  Labels labels_;
};

// The bundle of a job, ready for replay: with what the server answered, not what the robot got.
// nullopt if no request was made, e.g. without a camera frame. The version may be empty.
std::optional<v1::Bundle> BundleOf(const JobReport& report, const std::string& server_version);

}  // namespace graspdb::client
