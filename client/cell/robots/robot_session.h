// The state of robots and their jobs, independent of the protocol.
#pragma once

#include <cstddef>
#include <deque>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
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

// Its code and sentence.
JobAnswer AnswerOf(const absl::Status& status);

// The last scene that a JobRunner recognised for a robot; the derived type is the runner's.
class RunnerScene {
 public:
  virtual ~RunnerScene() = default;
};

// The state of a robot between its requests, over all of its connections. Thread-safe; no lock is
// held while a job runs.
class RobotSession {
 public:
  // `robot` identifies the robot, e.g. by its address. The destructor waits for kept work.
  explicit RobotSession(std::string robot) : robot_(std::move(robot)) {}

  const std::string& robot() const { return robot_; }

  // The pose format that the robot set, a code of pose_format.h.
  std::optional<int> format() const;
  void SetFormat(int format);

  // Begins a run of the job and discards its previous results; JOB_STILL_RUNNING.
  JobAnswer BeginRun(int job);
  void EndRun(int job, absl::StatusOr<std::vector<JobPose>> found);
  // Why the running job finds no pose: the sentence of the first Next after it.
  void SetNoPoseReason(int job, std::string reason);
  // Keeps a run in the background until the next one of the job, or the destructor.
  void Keep(int job, std::future<void> run);

  // Whether any job is running.
  bool IsRunning() const;
  GriJobStatus StatusOf(int job);

  // Takes the next primary pose. NO_POSES_FOUND when none is left, and the job is then inactive;
  // NO_RETURN_SPECIFIED when the job is done and does not return poses; JOB_STILL_RUNNING; or the
  // job's error.
  JobAnswer Next(int job, bool returns_poses);

  // Takes the next pose that is related to the primary taken last, which gets its grasp.
  // NO_RELATED_POSES when none is left; JOB_STILL_RUNNING; or the job's error.
  JobAnswer NextRelated(int job);

  // The last primary taken; none before the first and after a new run.
  std::optional<JobPose> LastPrimary(int job);

  // Discards the last primary and its related poses, because it could not be sent.
  void SkipPrimary(int job);

  // The pose given to the robot last, while its outcome is pending.
  void SetGiven(JobPose pose);
  std::optional<JobPose> TakeGiven();
  // Reverts TakeGiven, unless another pose was given meanwhile.
  void RestoreGiven(JobPose pose);

  // Null before the first.
  std::shared_ptr<const RunnerScene> scene() const;
  void SetScene(std::shared_ptr<const RunnerScene> scene);

 private:
  struct Results {
    GriJobStatus status = GriJobStatus::kInactive;
    absl::Status failure = {};
    std::string no_pose_reason = {};
    std::deque<JobPose> left = {};
    std::optional<JobPose> primary = {};  // taken last
    std::deque<recognition::Pose> related = {};

    JobAnswer Give(const recognition::Pose& base_pose) const;
  };

  const std::string robot_;
  mutable absl::Mutex mutex_;
  std::optional<int> format_ ABSL_GUARDED_BY(mutex_);
  std::map<int, Results> results_ ABSL_GUARDED_BY(mutex_);  // by job
  std::optional<JobPose> given_ ABSL_GUARDED_BY(mutex_);
  std::shared_ptr<const RunnerScene> scene_ ABSL_GUARDED_BY(mutex_);
  // Destroyed first: waits for the runs that use the members above. By job.
  std::map<int, std::future<void>> runs_ ABSL_GUARDED_BY(mutex_);
};

// Maximum number of sessions, far more than the robots of a cell. Twice as many take twice the
// memory, mostly of their scenes (responses of the server).
inline constexpr std::size_t kMaxSessions = 64;

// Sessions belong to the robot's address, so that a robot may reconnect for every message, and
// robots do not take each other's poses. Thread-safe.
class RobotJobs {
 public:
  // `runner` must outlive this. The destructor waits for running jobs.
  explicit RobotJobs(JobRunner& runner) : runner_(runner) {}

  JobRunner& runner() { return runner_; }

  // The session of the robot; a new one if it has none, in place of the least recently used one if
  // there are kMaxSessions. Sessions in use (shared with a caller) and those with a running job are
  // not replaced: RESOURCE_EXHAUSTED, logged, if there are no others.
  absl::StatusOr<std::shared_ptr<RobotSession>> SessionOf(const std::string& robot)
      ABSL_LOCKS_EXCLUDED(mutex_);

  // kNoError if the job exists, or its error. Must be called before the others.
  JobAnswer Check(int job);

  // Runs the job and takes its first primary pose as Next does. JOB_STILL_RUNNING when it is
  // already running. Discards the previous results.
  JobAnswer Run(const JobRequest& request);

  // The same, but does not wait for the job and takes no pose.
  JobAnswer Start(const JobRequest& request);

  // RobotSession::Next.
  JobAnswer Next(RobotSession& session, int job);

 private:
  JobRunner& runner_;
  absl::Mutex mutex_;
  // The least recently used one first.
  std::vector<std::shared_ptr<RobotSession>> sessions_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace graspdb::client
