#include "client/cell/robots/robot_jobs.h"

#include <deque>
#include <exception>
#include <future>
#include <new>
#include <system_error>
#include <utility>
#include <vector>

namespace graspdb::client {
namespace {

JobAnswer Refusal(GriCode code, std::string why) { return {.code = code, .why = std::move(why)}; }

JobAnswer Refusal(const absl::Status& status) {
  return Refusal(GriCodeOf(status), std::string(status.message()));
}

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

JobAnswer StillRunning() {
  return Refusal(GriCode::kJobStillRunning,
                 "the job is running; request its result a little later");
}

}  // namespace

// The results of one job for one robot. Thread-safe.
class RobotJobs::Found {
 public:
  // Discards the previous results. False if the job is already running.
  bool Begin() {
    absl::MutexLock lock(&mutex_);
    if (status_ == GriJobStatus::kRunning) return false;
    status_ = GriJobStatus::kRunning;
    left_.clear();
    related_.clear();
    primary_.reset();
    return true;
  }

  void End(absl::StatusOr<std::vector<JobPose>> found) {
    absl::MutexLock lock(&mutex_);
    failure_ = found.status();
    status_ = found.ok() ? GriJobStatus::kDone : GriJobStatus::kFailed;
    if (found.ok()) left_.assign(found->begin(), found->end());
  }

  GriJobStatus status() const {
    absl::MutexLock lock(&mutex_);
    return status_;
  }

  JobAnswer NextPrimary(bool returns_poses) {
    absl::MutexLock lock(&mutex_);
    if (status_ == GriJobStatus::kRunning) return StillRunning();
    if (status_ == GriJobStatus::kFailed) return Refusal(failure_);
    if (left_.empty()) {
      const bool is_done = std::exchange(status_, GriJobStatus::kInactive) == GriJobStatus::kDone;
      related_.clear();
      if (is_done && !returns_poses) {
        return Refusal(GriCode::kNoReturnSpecified, "done; this job gives no poses");
      }
      return Refusal(GriCode::kNoPosesFound, "the job has no pose left; run it again");
    }
    primary_ = std::move(left_.front());
    left_.pop_front();
    related_.assign(primary_->base_related.begin(), primary_->base_related.end());
    return Give(primary_->base_primary);
  }

  JobAnswer NextRelated() {
    absl::MutexLock lock(&mutex_);
    if (status_ == GriJobStatus::kRunning) return StillRunning();
    if (status_ == GriJobStatus::kFailed) return Refusal(failure_);
    if (related_.empty()) {
      return Refusal(GriCode::kNoRelatedPoses, "nothing more is related to the pose given last");
    }
    const recognition::Pose next = related_.front();
    related_.pop_front();
    return Give(next);
  }

  std::optional<JobPose> last_primary() const {
    absl::MutexLock lock(&mutex_);
    return primary_;
  }

  void SkipPrimary() {
    absl::MutexLock lock(&mutex_);
    primary_.reset();
    related_.clear();
  }

  // Background work, kept until the next run or the destructor.
  void Keep(std::future<void> work) {
    {
      absl::MutexLock lock(&mutex_);
      std::swap(work_, work);
    }
    // The previous work ends here, outside the lock that its End needs.
    work = {};
  }

 private:
  JobAnswer Give(const recognition::Pose& base_pose) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    return {.base_pose = base_pose,
            .primary = primary_.value_or(JobPose()),
            .primaries_left = left_.size(),
            .related_left = related_.size()};
  }

  mutable absl::Mutex mutex_;
  GriJobStatus status_ ABSL_GUARDED_BY(mutex_) = GriJobStatus::kInactive;
  absl::Status failure_ ABSL_GUARDED_BY(mutex_);
  std::deque<JobPose> left_ ABSL_GUARDED_BY(mutex_);
  std::optional<JobPose> primary_ ABSL_GUARDED_BY(mutex_);  // taken last
  std::deque<recognition::Pose> related_ ABSL_GUARDED_BY(mutex_);
  // Destroyed first: waits for the work that uses the members above.
  std::future<void> work_ ABSL_GUARDED_BY(mutex_);
};

RobotJobs::RobotJobs(JobRunner& runner) : runner_(runner) {}

RobotJobs::~RobotJobs() = default;

RobotJobs::Found* RobotJobs::FoundOf(const std::string& robot, int job) {
  absl::MutexLock lock(&mutex_);
  std::unique_ptr<Found>& found = found_[{robot, job}];
  if (found == nullptr) found = std::make_unique<Found>();
  return found.get();
}

JobAnswer RobotJobs::Check(int job) {
  const absl::Status status = runner_.Check(job);
  return status.ok() ? JobAnswer() : Refusal(status);
}

JobAnswer RobotJobs::Run(const JobRequest& request) {
  Found* found = FoundOf(request.robot, request.job);
  if (!found->Begin()) return StillRunning();
  found->End(RunGuarded(runner_, request));
  return Next(request.robot, request.job);
}

JobAnswer RobotJobs::Start(const JobRequest& request) {
  Found* found = FoundOf(request.robot, request.job);
  if (!found->Begin()) return StillRunning();
  try {
    found->Keep(std::async(std::launch::async,
                           [this, found, request] { found->End(RunGuarded(runner_, request)); }));
  } catch (const std::system_error&) {
    const auto error = absl::ResourceExhaustedError("no thread is left; check the system's limits");
    found->End(error);
    return Refusal(error);
  }
  return {};
}

GriJobStatus RobotJobs::StatusOf(const std::string& robot, int job) {
  return FoundOf(robot, job)->status();
}

JobAnswer RobotJobs::Next(const std::string& robot, int job) {
  return FoundOf(robot, job)->NextPrimary(runner_.ReturnsPoses(job));
}

JobAnswer RobotJobs::NextRelated(const std::string& robot, int job) {
  return FoundOf(robot, job)->NextRelated();
}

std::optional<JobPose> RobotJobs::LastPrimary(const std::string& robot, int job) {
  return FoundOf(robot, job)->last_primary();
}

void RobotJobs::SkipPrimary(const std::string& robot, int job) {
  FoundOf(robot, job)->SkipPrimary();
}

}  // namespace graspdb::client
