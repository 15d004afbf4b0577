#include "client/cell/robots/robot_session.h"

#include <algorithm>

namespace graspdb::client {
namespace {

JobAnswer StillRunning() {
  return {.code = GriCode::kJobStillRunning,
          .why = "the job is running; request its result a little later"};
}

}  // namespace

JobAnswer AnswerOf(const absl::Status& status) {
  return {.code = GriCodeOf(status), .why = std::string(status.message())};
}

JobAnswer RobotSession::Results::Give(const recognition::Pose& base_pose) const {
  return {.base_pose = base_pose,
          .primary = primary.value_or(JobPose()),
          .primaries_left = left.size(),
          .related_left = related.size()};
}

std::optional<int> RobotSession::format() const {
  absl::MutexLock lock(&mutex_);
  return format_;
}

void RobotSession::SetFormat(int format) {
  absl::MutexLock lock(&mutex_);
  format_ = format;
}

JobAnswer RobotSession::BeginRun(int job) {
  absl::MutexLock lock(&mutex_);
  Results& results = results_[job];
  if (results.status == GriJobStatus::kRunning) return StillRunning();
  results = {.status = GriJobStatus::kRunning};
  return {};
}

void RobotSession::EndRun(int job, absl::StatusOr<std::vector<JobPose>> found) {
  absl::MutexLock lock(&mutex_);
  Results& results = results_[job];
  results.failure = found.status();
  results.status = found.ok() ? GriJobStatus::kDone : GriJobStatus::kFailed;
  if (found.ok()) results.left.assign(found->begin(), found->end());
}

void RobotSession::SetNoPoseReason(int job, std::string reason) {
  absl::MutexLock lock(&mutex_);
  results_[job].no_pose_reason = std::move(reason);
}

void RobotSession::Keep(int job, std::future<void> run) {
  absl::MutexLock lock(&mutex_);
  std::swap(runs_[job], run);  // the caller waits for the previous run's end, without the lock
}

bool RobotSession::IsRunning() const {
  absl::MutexLock lock(&mutex_);
  return std::ranges::any_of(
      results_, [](const auto& of) { return of.second.status == GriJobStatus::kRunning; });
}

GriJobStatus RobotSession::StatusOf(int job) {
  absl::MutexLock lock(&mutex_);
  return results_[job].status;
}

JobAnswer RobotSession::Next(int job, bool returns_poses) {
  absl::MutexLock lock(&mutex_);
  Results& results = results_[job];
  if (results.status == GriJobStatus::kRunning) return StillRunning();
  if (results.status == GriJobStatus::kFailed) return AnswerOf(results.failure);
  if (results.left.empty()) {
    const bool is_done =
        std::exchange(results.status, GriJobStatus::kInactive) == GriJobStatus::kDone;
    results.related.clear();
    if (is_done && !returns_poses) {
      return {.code = GriCode::kNoReturnSpecified, .why = "done; this job gives no poses"};
    }
    const std::string reason = std::exchange(results.no_pose_reason, "");
    return {.code = GriCode::kNoPosesFound,
            .why = reason.empty() ? "the job has no pose left; run it again" : reason};
  }
  JobPose& primary = results.primary.emplace(std::move(results.left.front()));
  results.left.pop_front();
  results.related.assign(primary.base_related.begin(), primary.base_related.end());
  return results.Give(primary.base_primary);
}

JobAnswer RobotSession::NextRelated(int job) {
  absl::MutexLock lock(&mutex_);
  Results& results = results_[job];
  if (results.status == GriJobStatus::kRunning) return StillRunning();
  if (results.status == GriJobStatus::kFailed) return AnswerOf(results.failure);
  if (results.related.empty()) {
    return {.code = GriCode::kNoRelatedPoses,
            .why = "nothing more is related to the pose given last"};
  }
  if (results.primary) {
    JobPose& primary = *results.primary;
    const std::size_t taken = primary.base_related.size() - results.related.size();
    if (taken < primary.related_grasps.size()) primary.grasp = primary.related_grasps[taken];
  }
  const recognition::Pose next = results.related.front();
  results.related.pop_front();
  return results.Give(next);
}

std::optional<JobPose> RobotSession::LastPrimary(int job) {
  absl::MutexLock lock(&mutex_);
  return results_[job].primary;
}

void RobotSession::SkipPrimary(int job) {
  absl::MutexLock lock(&mutex_);
  results_[job].primary.reset();
  results_[job].related.clear();
}

void RobotSession::SetGiven(JobPose pose) {
  absl::MutexLock lock(&mutex_);
  given_ = std::move(pose);
}

std::optional<JobPose> RobotSession::TakeGiven() {
  absl::MutexLock lock(&mutex_);
  return std::exchange(given_, std::nullopt);
}

void RobotSession::RestoreGiven(JobPose pose) {
  absl::MutexLock lock(&mutex_);
  if (!given_) given_ = std::move(pose);
}

std::shared_ptr<const RunnerScene> RobotSession::scene() const {
  absl::MutexLock lock(&mutex_);
  return scene_;
}

void RobotSession::SetScene(std::shared_ptr<const RunnerScene> scene) {
  absl::MutexLock lock(&mutex_);
  scene_.swap(scene);  // the previous one is freed without the lock
}

}  // namespace graspdb::client
