// The job actions of the Generic Robot Interface.
#pragma once

#include <string>

#include "client/cell/robots/gri/gri_message.h"
#include "client/cell/robots/robot_jobs.h"

namespace graspdb::client {

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

}  // namespace graspdb::client
