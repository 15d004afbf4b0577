// Jobs as the Generic Robot Interface asks for them.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "client/robots/gri_message.h"
#include "client/robots/job_runner.h"

namespace graspdb::client {

// The code by which a robot is told of an error of a JobRunner.
GriCode GriCodeOf(const absl::Status& status);

// Answers STATUS, TRIGGER_JOB_SYNC, TRIGGER_JOB_ASYNC, GET_JOB_STATUS, GET_NEXT_POSE and
// GET_RELATED_POSE. What a job has found is kept for each robot, so that one that connects anew
// for every message finds it again, and robots do not take each other's poses. Thread-safe.
class GriJobs {
 public:
  // `runner` must outlive this. The destructor waits for jobs that run.
  explicit GriJobs(JobRunner& runner);
  ~GriJobs();

  // `robot` is who asks, such as its address. The header must have been checked.
  GriResponse Answer(const std::string& robot, const GriRequest& request);

 private:
  class Run;

  Run* RunOf(const std::string& robot, int job) ABSL_LOCKS_EXCLUDED(mutex_);
  GriCode GivePrimary(const std::string& robot, Run* run, GriResponse* response);
  GriCode Trigger(const std::string& robot, Run* run, const GriRequest& request);

  JobRunner& runner_;
  absl::Mutex mutex_;
  std::map<std::pair<std::string, int>, std::unique_ptr<Run>> runs_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace graspdb::client
