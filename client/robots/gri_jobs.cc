#include "client/robots/gri_jobs.h"

#include <deque>
#include <future>
#include <optional>
#include <vector>

namespace graspdb::client {
namespace {

using recognition::Pose;

// Of GriResponse::data, counted from 0 where the documentation counts from 1.
constexpr std::size_t kReady = 1;
constexpr std::size_t kJobStatus = 1;
constexpr std::size_t kPrimaryLeft = 1;
constexpr std::size_t kRelatedLeft = 2;

std::int32_t CountOf(std::size_t count) { return static_cast<std::int32_t>(count); }

std::optional<Pose> FlangeOf(const GriRequest& request) {
  absl::StatusOr<Pose> pose = FromGriPose(request.pose, request.pose_format);
  return pose.ok() ? std::optional(*pose) : std::nullopt;
}

}  // namespace

GriCode GriCodeOf(const absl::Status& status) {
  switch (status.code()) {
    case absl::StatusCode::kOk:
      return GriCode::kNoError;
    case absl::StatusCode::kNotFound:
      return GriCode::kJobDoesNotExist;
    case absl::StatusCode::kFailedPrecondition:
      return GriCode::kMisconfiguredJob;
    case absl::StatusCode::kPermissionDenied:
      return GriCode::kWrongProtocolForJob;
    case absl::StatusCode::kInvalidArgument:
      return GriCode::kInvalidRequest;
    case absl::StatusCode::kUnavailable:
      return GriCode::kApiNotReachable;
    case absl::StatusCode::kDeadlineExceeded:
      return GriCode::kProcessingTimeout;
    case absl::StatusCode::kInternal:
      return GriCode::kInternalError;
    case absl::StatusCode::kUnknown:
      return GriCode::kUnknownError;
    default:
      return GriCode::kApiResponseError;
  }
}

// What one job has found for one robot. Thread-safe.
class GriJobs::Run {
 public:
  // False when it runs already; else what was found before is forgotten.
  bool Begin() {
    absl::MutexLock lock(&mutex_);
    if (status_ == GriJobStatus::kRunning) return false;
    status_ = GriJobStatus::kRunning;
    left_.clear();
    related_.clear();
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

  // Sets `given` where it gives one.
  GriCode NextPrimary(GriResponse* response, std::optional<JobPose>* given) {
    absl::MutexLock lock(&mutex_);
    if (status_ == GriJobStatus::kRunning) return GriCode::kJobStillRunning;
    if (status_ == GriJobStatus::kFailed) return GriCodeOf(failure_);
    if (left_.empty()) {
      status_ = GriJobStatus::kInactive;
      related_.clear();
      return GriCode::kNoPosesFound;
    }
    JobPose next = std::move(left_.front());
    left_.pop_front();
    related_.assign(next.base_related.begin(), next.base_related.end());
    const GriCode code = Give(next.base_primary, response);
    if (code == GriCode::kNoError) *given = std::move(next);
    return code;
  }

  GriCode NextRelated(GriResponse* response) {
    absl::MutexLock lock(&mutex_);
    if (status_ == GriJobStatus::kRunning) return GriCode::kJobStillRunning;
    if (status_ == GriJobStatus::kFailed) return GriCodeOf(failure_);
    if (related_.empty()) return GriCode::kNoRelatedPoses;
    const Pose next = related_.front();
    related_.pop_front();
    return Give(next, response);
  }

  // Done in the background until the next run, or until this goes.
  void Keep(std::future<void> work) {
    absl::MutexLock lock(&mutex_);
    work_ = std::move(work);
  }

 private:
  GriCode Give(const Pose& pose, GriResponse* response) const
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    response->data[kPrimaryLeft] = CountOf(left_.size());
    response->data[kRelatedLeft] = CountOf(related_.size());
    const absl::StatusOr<GriPose> sent = ToGriPose(pose, response->pose_format);
    if (!sent.ok()) return GriCodeOf(sent.status());
    response->pose = *sent;
    return GriCode::kNoError;
  }

  mutable absl::Mutex mutex_;
  GriJobStatus status_ ABSL_GUARDED_BY(mutex_) = GriJobStatus::kInactive;
  absl::Status failure_ ABSL_GUARDED_BY(mutex_);
  std::deque<JobPose> left_ ABSL_GUARDED_BY(mutex_);
  std::deque<Pose> related_ ABSL_GUARDED_BY(mutex_);
  // Goes first: it waits for what uses the others.
  std::future<void> work_ ABSL_GUARDED_BY(mutex_);
};

GriJobs::GriJobs(JobRunner& runner) : runner_(runner) {}

GriJobs::~GriJobs() = default;

GriJobs::Run* GriJobs::RunOf(const std::string& robot, int job) {
  absl::MutexLock lock(&mutex_);
  std::unique_ptr<Run>& run = runs_[{robot, job}];
  if (run == nullptr) run = std::make_unique<Run>();
  return run.get();
}

GriCode GriJobs::GivePrimary(const std::string& robot, Run* run, GriResponse* response) {
  std::optional<JobPose> given;
  const GriCode code = run->NextPrimary(response, &given);
  if (given) runner_.Given(robot, *given);
  return code;
}

GriCode GriJobs::Trigger(const std::string& robot, Run* run, const GriRequest& request) {
  if (!run->Begin()) return GriCode::kJobStillRunning;
  const auto work = [this, run, job = JobRequest{request.job_id, robot, FlangeOf(request)}] {
    run->End(runner_.Run(job));
  };
  if (static_cast<GriAction>(request.action) == GriAction::kTriggerJobSync) {
    work();
  } else {
    run->Keep(std::async(std::launch::async, work));
  }
  return GriCode::kNoError;
}

GriResponse GriJobs::Answer(const std::string& robot, const GriRequest& request) {
  GriResponse out;
  out.pose_format = request.pose_format;
  out.action = request.action;
  out.job_id = request.job_id;
  const auto action = static_cast<GriAction>(request.action);
  if (action == GriAction::kStatus) {
    out.data[kReady] = runner_.IsReady() ? 1 : 0;
    return out;
  }
  if (absl::Status status = runner_.Check(request.job_id); !status.ok()) {
    out.code = GriCodeOf(status);
    return out;
  }
  Run* run = RunOf(robot, request.job_id);
  switch (action) {
    case GriAction::kTriggerJobSync:
      out.code = Trigger(robot, run, request);
      if (out.code == GriCode::kNoError) out.code = GivePrimary(robot, run, &out);
      break;
    case GriAction::kTriggerJobAsync:
      out.code = Trigger(robot, run, request);
      break;
    case GriAction::kGetJobStatus:
      out.data[kJobStatus] = static_cast<std::int32_t>(run->status());
      break;
    case GriAction::kGetNextPose:
      out.code = GivePrimary(robot, run, &out);
      break;
    case GriAction::kGetRelatedPose:
      out.code = run->NextRelated(&out);
      break;
    default:
      out.code = GriCode::kInvalidAction;
  }
  return out;
}

}  // namespace graspdb::client
