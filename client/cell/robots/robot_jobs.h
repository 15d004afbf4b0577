// Runs the jobs of robots, independent of the protocol.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "client/cell/robots/robot_session.h"

namespace graspdb::client {

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
