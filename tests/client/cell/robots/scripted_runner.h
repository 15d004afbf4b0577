// A JobRunner with scripted results, which records reported outcomes.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "client/cell/robots/job_runner.h"

namespace graspdb::client {

// Thread-safe.
class ScriptedRunner : public JobRunner {
 public:
  // The result of job `job` from now on.
  void Set(int job, absl::StatusOr<std::vector<JobPose>> found);
  // The result of Check; only jobs that have been set exist.
  void Refuse(int job, absl::Status refusal);
  void SetReady(bool ready);

  bool IsReady() override;
  absl::Status Check(int job) override;
  absl::StatusOr<std::vector<JobPose>> Run(const JobRequest& request) override;
  absl::Status ReportOutcome(RobotSession& session, PickOutcome outcome) override;

  // Of the last Run.
  std::optional<recognition::Pose> base_flange();
  // "robot/grasp" and outcome, in order of ReportOutcome.
  using ReportedOutcome = std::pair<std::string, PickOutcome>;
  std::vector<ReportedOutcome> outcomes();

 private:
  absl::Mutex mutex_;
  bool ready_ ABSL_GUARDED_BY(mutex_) = true;
  std::map<int, absl::StatusOr<std::vector<JobPose>>> found_ ABSL_GUARDED_BY(mutex_);
  std::map<int, absl::Status> refusals_ ABSL_GUARDED_BY(mutex_);
  std::vector<ReportedOutcome> outcomes_ ABSL_GUARDED_BY(mutex_);
  std::optional<recognition::Pose> base_flange_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace graspdb::client
