// A job runner of the tests.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/synchronization/mutex.h"
#include "absl/synchronization/notification.h"
#include "client/cell/robots/gri/gri_protocol.h"

namespace graspdb::client {

inline constexpr int kFakeJob = 7;

// Returns scripted poses; records which pose the robot was given before a run.
class FakeJobRunner : public JobRunner {
 public:
  bool IsReady() override { return ready; }
  absl::Status Check(int job) override {
    return job == kFakeJob ? absl::OkStatus() : absl::NotFoundError("no such job");
  }
  absl::StatusOr<std::vector<JobPose>> Run(const JobRequest& request) override {
    if (go_on != nullptr) go_on->WaitForNotification();
    const absl::MutexLock lock(&mutex_);
    base_flange = request.base_flange;
    pose_fault = request.pose_fault;
    if (const std::optional<JobPose> last = request.session.TakeGiven()) {
      given.emplace_back(request.session.robot(), last->base_primary.translation().x());
    }
    return found;
  }
  absl::Status ReportOutcome(RobotSession& /*session*/, PickOutcome /*outcome*/) override {
    return absl::OkStatus();
  }

  bool ReturnsPoses(int /*job*/) override { return returns_poses; }

  bool ready = true;
  bool returns_poses = true;
  absl::Notification* go_on = nullptr;
  std::optional<recognition::Pose> base_flange;
  std::string pose_fault;
  std::vector<std::pair<std::string, double>> given;
  absl::StatusOr<std::vector<JobPose>> found = std::vector<JobPose>();

 private:
  absl::Mutex mutex_;  // of concurrent runs
};

}  // namespace graspdb::client
