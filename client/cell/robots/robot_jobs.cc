#include "client/cell/robots/robot_jobs.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <exception>
#include <future>
#include <new>
#include <system_error>
#include <utility>

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

}  // namespace

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
