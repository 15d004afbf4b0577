#include "tests/client/cell/robots/scripted_runner.h"

#include "client/cell/robots/robot_session.h"

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

absl::Status ScriptedRunner::ReportOutcome(RobotSession& session, PickOutcome outcome) {
  const std::optional<JobPose> given = session.TakeGiven();
  if (!given) return absl::FailedPreconditionError("no pose was given; run a job first");
  absl::MutexLock lock(&mutex_);
  outcomes_.emplace_back(session.robot() + "/" + given->grasp.grasp_id(), outcome);
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
