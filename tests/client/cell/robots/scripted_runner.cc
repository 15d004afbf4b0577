#include "tests/client/cell/robots/scripted_runner.h"

namespace graspdb::client {

void ScriptedRunner::Set(int job, absl::StatusOr<std::vector<JobPose>> found) {
  absl::MutexLock lock(&mutex_);
  found_.insert_or_assign(job, std::move(found));
}

void ScriptedRunner::Refuse(int job, absl::Status refusal) {
  absl::MutexLock lock(&mutex_);
  refusals_.insert_or_assign(job, std::move(refusal));
}

void ScriptedRunner::SetReady(bool ready) {
  absl::MutexLock lock(&mutex_);
  ready_ = ready;
}

bool ScriptedRunner::IsReady() {
  absl::MutexLock lock(&mutex_);
  return ready_;
}

absl::Status ScriptedRunner::Check(int job) {
  absl::MutexLock lock(&mutex_);
  if (const auto refusal = refusals_.find(job); refusal != refusals_.end()) return refusal->second;
  return found_.contains(job) ? absl::OkStatus() : absl::NotFoundError("there is no such job");
}

absl::StatusOr<std::vector<JobPose>> ScriptedRunner::Run(const JobRequest& request) {
  absl::MutexLock lock(&mutex_);
  base_flange_ = request.base_flange;
  return found_.at(request.job);
}

void ScriptedRunner::Given(const std::string& robot, const JobPose& pose) {
  absl::MutexLock lock(&mutex_);
  given_.insert_or_assign(robot, pose);
}

absl::Status ScriptedRunner::ReportOutcome(const std::string& robot, PickOutcome outcome) {
  absl::MutexLock lock(&mutex_);
  const auto given = given_.find(robot);
  if (given == given_.end()) {
    return absl::FailedPreconditionError("no pose was given; run a job first");
  }
  outcomes_.emplace_back(robot + "/" + given->second.grasp_id, outcome);
  given_.erase(given);
  return absl::OkStatus();
}

std::optional<recognition::Pose> ScriptedRunner::base_flange() {
  absl::MutexLock lock(&mutex_);
  return base_flange_;
}

std::vector<ScriptedRunner::ReportedOutcome> ScriptedRunner::outcomes() {
  absl::MutexLock lock(&mutex_);
  return outcomes_;
}

}  // namespace graspdb::client
