// Jobs of robots, whatever protocol they speak: which run, and what they have found that the robot
// has not asked for yet.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "client/cell/robots/gri_code.h"
#include "client/cell/robots/job_runner.h"

namespace graspdb::client {

// What a robot is told of its job. Where `code` is not kNoError only `why` counts: a sentence that
// says what is wrong and what to do.
struct JobAnswer {
  GriCode code = GriCode::kNoError;
  std::string why = {};
  recognition::Pose base_pose = recognition::Pose::Identity();  // primary or related
  JobPose primary = {};  // the primary that it is, or that it is related to
  std::size_t primaries_left = 0;
  std::size_t related_left = 0;
};

// What a job has found is kept for each robot (its address and the job's number), so that one that
// connects anew for every message finds it again, and robots do not take each other's poses.
// Thread-safe.
class RobotJobs {
 public:
  // `runner` must outlive this. The destructor waits for jobs that run.
  explicit RobotJobs(JobRunner& runner);
  ~RobotJobs();

  JobRunner& runner() { return runner_; }

  // kNoError when there is such a job, or what is wrong with it. To be asked before the others.
  JobAnswer Check(int job);

  // Runs the job and takes its first primary pose as Next does. JOB_STILL_RUNNING when it runs
  // already. What was found before is forgotten.
  JobAnswer Run(const JobRequest& request);

  // The same, but does not wait for the job, and takes nothing.
  JobAnswer Start(const JobRequest& request);

  GriJobStatus StatusOf(const std::string& robot, int job);

  // Takes the next primary pose. NO_POSES_FOUND when none is left, and the job is then inactive;
  // NO_RETURN_SPECIFIED when it is done and gives none;
  // JOB_STILL_RUNNING; or why the job failed.
  JobAnswer Next(const std::string& robot, int job);

  // Takes the next pose that is related to the primary taken last. NO_RELATED_POSES when none is
  // left; JOB_STILL_RUNNING; or why the job failed.
  JobAnswer NextRelated(const std::string& robot, int job);

  // The primary that was taken last; none before the first and after a new run.
  std::optional<JobPose> LastPrimary(const std::string& robot, int job);

  // The primary that was taken last could not be said: there is no last primary then, and nothing
  // related to it.
  void PassOver(const std::string& robot, int job);

 private:
  class Found;

  Found* FoundOf(const std::string& robot, int job) ABSL_LOCKS_EXCLUDED(mutex_);

  JobRunner& runner_;
  absl::Mutex mutex_;
  std::map<std::pair<std::string, int>, std::unique_ptr<Found>> found_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace graspdb::client
