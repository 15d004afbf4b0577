// A server of scripted jobs for robots in other processes: prints "gri PORT", and serves until its
// standard input ends. The jobs are those of third_party/gri_conformance_test.py.
#include <spdlog/spdlog.h>

#include <Eigen/Geometry>
#include <iostream>
#include <limits>
#include <numbers>
#include <vector>

#include "absl/synchronization/notification.h"
#include "client/cell/robots/gri/gri_protocol.h"
#include "client/cell/robots/robot_server.h"
#include "tests/client/cell/robots/scripted_runner.h"

namespace graspdb::client {
namespace {

using recognition::Pose;

enum Job { kEcho = 1, kTwoGrasps = 2, kNothing = 3, kSlow = 4, kGoOn = 5, kFar = 6, kStores = 20 };

Pose At(double x_m) {
  const auto turn = [](double degrees, const Eigen::Vector3d& axis) {
    return Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis);
  };
  Pose out = Pose::Identity();
  out.linear() = (turn(30, Eigen::Vector3d::UnitZ()) * turn(20, Eigen::Vector3d::UnitY()) *
                  turn(10, Eigen::Vector3d::UnitX()))
                     .toRotationMatrix();
  out.translation() << x_m, 0.2, -0.3;
  return out;
}

// Jobs that depend on the request, in addition to the scripted ones.
class Jobs : public ScriptedRunner {
 public:
  Jobs() {
    Set(kEcho, std::vector<JobPose>());
    Set(kTwoGrasps, std::vector<JobPose>{{At(0.1), {At(0.11)}}, {At(0.2), {}}});
    Set(kNothing, std::vector<JobPose>());
    Set(kSlow, std::vector<JobPose>{{At(0.1), {}}});
    Set(kGoOn, std::vector<JobPose>());
    Set(kFar, std::vector<JobPose>{{At(2.2), {}}});
    Set(11, absl::UnknownError(""));
    Set(12, absl::InternalError(""));
    Set(13, absl::UnavailableError(""));
    Set(14, absl::ResourceExhaustedError(""));
    Set(15, absl::InvalidArgumentError(""));
    Set(16, absl::DeadlineExceededError(""));
    Refuse(17, absl::PermissionDeniedError(""));
    Refuse(18, absl::FailedPreconditionError(""));
    Set(19, absl::AbortedError(""));
    Set(kStores, std::vector<JobPose>());
  }

  bool ReturnsPoses(int job) override { return job != kStores; }

  absl::StatusOr<std::vector<JobPose>> Run(const JobRequest& request) override {
    if (request.job == kEcho) {
      if (!request.base_flange) return absl::InvalidArgumentError("where is the robot?");
      return std::vector<JobPose>{{*request.base_flange, {}}};
    }
    if (request.job == kGoOn) go_on_.Notify();  // the test runs this once
    if (request.job == kSlow) go_on_.WaitForNotification();
    return ScriptedRunner::Run(request);
  }

 private:
  absl::Notification go_on_;
};

int Serve() {
  spdlog::set_level(spdlog::level::warn);  // the output is the test's
  Jobs runner;
  GriJobs jobs(runner);
  GriProtocol protocol(jobs);
  const auto server = RobotServer::Start(protocol, {});
  if (!server.ok()) {
    std::cerr << server.status() << "\n";
    return 1;
  }
  std::cout << "gri " << (*server)->port() << std::endl;
  std::cin.ignore(std::numeric_limits<std::streamsize>::max());
  return 0;
}

}  // namespace
}  // namespace graspdb::client

int main() { return graspdb::client::Serve(); }
