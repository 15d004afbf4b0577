#include "client/cell/robots/robot_session.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <exception>
#include <new>
#include <system_error>

#include "absl/strings/str_cat.h"

namespace graspdb::client {
namespace {

// An exception of a library must not leave the job in the running state.
absl::StatusOr<std::vector<JobPose>> RunGuarded(JobRunner& runner, const JobRequest& request) {
  try {
    return runner.Run(request);
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError("no memory is left for the job; run it again later");
  } catch (const std::exception& e) {
    return absl::InternalError("the job failed (" + std::string(e.what()) + "); run it again");
  }
}

// The list's lock must be held: then a session that only the list refers to cannot get into use.
bool IsReplaceable(const std::shared_ptr<RobotSession>& session) {
  return session.use_count() == 1 && !session->IsRunning();
}

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

absl::StatusOr<std::shared_ptr<RobotSession>> RobotJobs::SessionOf(const std::string& robot) {
  std::shared_ptr<RobotSession> replaced;  // freed without the lock
  absl::MutexLock lock(&mutex_);
  auto at = std::ranges::find(sessions_, robot, [](const auto& of) { return of->robot(); });
  if (at == sessions_.end() && sessions_.size() < kMaxSessions) {
    at = sessions_.insert(at, std::make_shared<RobotSession>(robot));
  } else if (at == sessions_.end()) {
    at = std::ranges::find_if(sessions_, IsReplaceable);
    if (at == sessions_.end()) {
      spdlog::warn("event=robot_refused robot={} running={}", robot, kMaxSessions);
      return absl::ResourceExhaustedError(
          absl::StrCat("jobs of ", kMaxSessions, " other robots are running; try again later"));
    }
    spdlog::warn("event=robot_replaced robot={} replaced={}", robot, (*at)->robot());
    replaced = std::exchange(*at, std::make_shared<RobotSession>(robot));
  }
  std::rotate(at, at + 1, sessions_.end());
  return sessions_.back();
}

JobAnswer RobotJobs::Check(int job) { return AnswerOf(runner_.Check(job)); }

JobAnswer RobotJobs::Run(const JobRequest& request) {
  RobotSession& session = request.session;
  JobAnswer begun = session.BeginRun(request.job);
  if (begun.code != GriCode::kNoError) return begun;
  session.EndRun(request.job, RunGuarded(runner_, request));
  return Next(session, request.job);
}

JobAnswer RobotJobs::Start(const JobRequest& request) {
  RobotSession& session = request.session;
  JobAnswer begun = session.BeginRun(request.job);
  if (begun.code != GriCode::kNoError) return begun;
  try {
    session.Keep(request.job, std::async(std::launch::async, [this, request] {
                   request.session.EndRun(request.job, RunGuarded(runner_, request));
                 }));
  } catch (const std::system_error&) {
    const auto error = absl::ResourceExhaustedError("no thread is left; check the system's limits");
    session.EndRun(request.job, error);
    return AnswerOf(error);
  }
  return {};
}

JobAnswer RobotJobs::Next(RobotSession& session, int job) {
  return session.Next(job, runner_.ReturnsPoses(job));
}

}  // namespace graspdb::client
