// Jobs of robots, independent of the protocol: their state, and the results that the robot has not
// fetched yet.
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

// The answer to a robot about its job. If `code` is not kNoError, only `why` is set: a sentence
// with the problem and the next step.
struct JobAnswer {
  GriCode code = GriCode::kNoError;
  std::string why = {};
  recognition::Pose base_pose = recognition::Pose::Identity();  // primary or related
  JobPose primary = {};  // the primary itself, or the one it is related to
  std::size_t primaries_left = 0;
  std::size_t related_left = 0;
};

// Results are kept per robot (its address and the job's number), so that a robot may reconnect for
// every message, and robots do not take each other's poses. Thread-safe.
class RobotJobs {
 public:
  // `runner` must outlive this. The destructor waits for running jobs.
  explicit RobotJobs(JobRunner& runner);
  ~RobotJobs();

  JobRunner& runner() { return runner_; }

  // kNoError if the job exists, or its error. Must be called before the others.
  JobAnswer Check(int job);

  // Runs the job and takes its first primary pose as Next does. JOB_STILL_RUNNING when it is
  // already running. Discards the previous results.
  JobAnswer Run(const JobRequest& request);

  // The same, but does not wait for the job and takes no pose.
  JobAnswer Start(const JobRequest& request);

  GriJobStatus StatusOf(const std::string& robot, int job);

  // Takes the next primary pose. NO_POSES_FOUND when none is left, and the job is then inactive;
  // NO_RETURN_SPECIFIED when the job is done and returns no poses; JOB_STILL_RUNNING; or the job's
  // error.
  JobAnswer Next(const std::string& robot, int job);

  // Takes the next pose that is related to the primary taken last. NO_RELATED_POSES when none is
  // left; JOB_STILL_RUNNING; or the job's error.
  JobAnswer NextRelated(const std::string& robot, int job);

  // The last primary taken; none before the first and after a new run.
  std::optional<JobPose> LastPrimary(const std::string& robot, int job);

  // Discards the last primary and its related poses, because it could not be sent.
  void SkipPrimary(const std::string& robot, int job);

 private:
  class Found;

  Found* FoundOf(const std::string& robot, int job) ABSL_LOCKS_EXCLUDED(mutex_);

  JobRunner& runner_;
  absl::Mutex mutex_;
  std::map<std::pair<std::string, int>, std::unique_ptr<Found>> found_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace graspdb::client
