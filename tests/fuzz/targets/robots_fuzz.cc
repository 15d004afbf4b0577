// Messages of a robot: an input that begins with "GRI" goes to the Generic Robot Interface, every
// other one to the line protocol.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

#include "client/cell/robots/gri/gri_protocol.h"
#include "client/cell/robots/line/line_protocol.h"
#include "tests/client/cell/robots/scripted_runner.h"
#include "tests/fuzz/requirement.h"

namespace graspdb::fuzz {
namespace {

using client::JobPose;

constexpr char kRobot[] = "10.0.0.7";

JobPose PoseAt(double x) {
  JobPose pose;
  pose.base_primary.translation() = Eigen::Vector3d(x, 0.1, 0.2);
  pose.base_related = {pose.base_primary, client::JobPose().base_primary};
  pose.object = "objects/flange";
  pose.stable_pose = "objects/flange/stablePoses/flat";
  pose.grasp.set_grasp_id("top");
  pose.score = 0.9;
  return pose;
}

// Jobs 1 to 5: poses, poses that cannot be encoded, no poses, an error, a rejection.
void SetJobs(client::ScriptedRunner& runner) {
  runner.Set(1, std::vector<JobPose>{PoseAt(0.3), PoseAt(-1.2), PoseAt(0)});
  JobPose long_name = PoseAt(0.1);
  long_name.object = std::string(300, 'x');
  runner.Set(2, std::vector<JobPose>{PoseAt(1e12), PoseAt(std::numeric_limits<double>::quiet_NaN()),
                                     long_name, PoseAt(0.4)});
  runner.Set(3, std::vector<JobPose>());
  runner.Set(4, absl::UnavailableError("the server\nis not there; start it"));
  runner.Set(5, std::vector<JobPose>{PoseAt(0.3)});
  runner.Refuse(5, absl::PermissionDeniedError("the job is meant for another protocol"));
}

// Pipeline 0 can be calibrated.
class OnePipeline : public client::RobotCalibrator {
 public:
  absl::Status Check(int pipeline) override {
    return pipeline == 0 ? absl::OkStatus() : absl::NotFoundError("there is one pipeline, 0");
  }
  absl::Status Init(int) override { return absl::OkStatus(); }
  absl::Status SetPose(int, int slot, const recognition::Pose& base_flange) override {
    Require(slot >= 0 && slot <= client::kLastHecSlot, "a slot that exists");
    Require(base_flange.matrix().allFinite(), "a finite pose of the flange");
    const Eigen::Matrix3d turn = base_flange.linear();
    Require((turn * turn.transpose()).isIdentity(1e-6), "a rotation of the flange");
    return absl::OkStatus();
  }
  absl::StatusOr<client::CalibrationReport> Calibrate(int) override {
    return client::CalibrationReport{.shift_m = 1e9, .turn_rad = 0.01, .used = 5, .poses = 6};
  }
};

void RequireGriReply(const std::string& reply) {
  Require(reply.size() == client::kGriResponseBytes, "a GRI answer of 80 bytes");
  std::array<std::uint8_t, client::kGriResponseBytes> bytes = {};
  std::ranges::copy(reply, bytes.begin());
  Require(client::ParseGriResponse(bytes).ok(), "a GRI answer that a robot can read");
}

void RequireLine(const std::string& reply) {
  Require(reply.size() <= client::kMaxReplyBytes, "an answer that fits a controller's string");
  Require(reply.ends_with('\n') && reply.find('\n') == reply.size() - 1, "an answer of one line");
  const auto is_printable = [](char c) { return c >= ' ' && c <= '~'; };
  Require(std::all_of(reply.begin(), reply.end() - 1, is_printable), "an answer of ASCII");
  Require(reply.starts_with("OK") || reply.starts_with("ERR "), "OK or ERR");
}

// Splits received bytes into messages like RobotConnection.
void Converse(client::RobotProtocol& protocol, std::string_view received,
              void (*require)(const std::string&)) {
  while (!received.empty()) {
    const std::size_t bytes = protocol.MessageBytes(received);
    if (bytes == 0) return;
    Require(bytes <= received.size(), "a message within the received bytes");
    const client::RobotReply reply = protocol.Answer(kRobot, received.substr(0, bytes));
    require(reply.bytes);
    if (reply.hang_up) return;
    received.remove_prefix(bytes);
  }
}

void Connect(std::string_view sent) {
  client::ScriptedRunner runner;
  SetJobs(runner);
  if (sent.starts_with("GRI")) {
    OnePipeline calibrator;
    client::GriJobs jobs(runner);
    client::GriProtocol protocol(jobs, &calibrator);
    Converse(protocol, sent, RequireGriReply);
  } else {
    client::LineProtocol protocol(runner);
    Converse(protocol, sent, RequireLine);
  }
}

}  // namespace
}  // namespace graspdb::fuzz

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  spdlog::set_level(spdlog::level::off);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  graspdb::fuzz::Connect({reinterpret_cast<const char*>(data), size});
  return 0;
}
