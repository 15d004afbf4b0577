// A JobRunner that finds what a test tells it to, and remembers what it is told.
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
  // What job `job` finds from now on, or the error that it ends with.
  void Set(int job, absl::StatusOr<std::vector<JobPose>> found);
  // What Check says of it; only jobs that have been set exist.
  void Refuse(int job, absl::Status refusal);
  void SetReady(bool ready);

  bool IsReady() override;
  absl::Status Check(int job) override;
  absl::StatusOr<std::vector<JobPose>> Run(const JobRequest& request) override;
  void Given(const std::string& robot, const JobPose& pose) override;
  absl::Status Tell(const std::string& robot, PickOutcome outcome) override;

  // Of the last Run.
  std::optional<recognition::Pose> base_flange();
  // "robot/grasp" and outcome, in the order in which they were told.
  using Told = std::pair<std::string, PickOutcome>;
  std::vector<Told> told();

 private:
  absl::Mutex mutex_;
  bool ready_ ABSL_GUARDED_BY(mutex_) = true;
  std::map<int, absl::StatusOr<std::vector<JobPose>>> found_ ABSL_GUARDED_BY(mutex_);
  std::map<int, absl::Status> refusals_ ABSL_GUARDED_BY(mutex_);
  std::map<std::string, JobPose> given_ ABSL_GUARDED_BY(mutex_);
  std::vector<Told> told_ ABSL_GUARDED_BY(mutex_);
  std::optional<recognition::Pose> base_flange_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace graspdb::client
