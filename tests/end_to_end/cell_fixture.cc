#include "tests/end_to_end/cell_fixture.h"

#include <chrono>
#include <fstream>
#include <thread>

#include "absl/strings/str_cat.h"
#include "files/messages/pose_message.h"
#include "graspdb/v1/cell.pb.h"
#include "lab/simulated_robot/pick_run.h"
#include "program/connections/listen_address.h"
#include "rendering/sample_parts.h"
#include "rendering/scene_file.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::end_to_end {

using client::GriAction;
using client::GriCode;
using client::GriRequest;
using client::GriResponse;
using recognition::Pose;
using testing::IsOk;

Pose CellProgramsTest::WorldBase() {
  Pose out(Eigen::Translation3d(-0.6, 0.2, 0.05));
  out.rotate(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()));
  return out;
}

void CellProgramsTest::StartCell() {
  StartServer();
  Simulate("teach", 15, 1);
  Succeed({"import", Path("teach"), "--split", "TEACH"});
  parts_ = rendering::SampleParts();
  std::erase_if(parts_, [](const rendering::Workpiece& part) {
    return part.object_id != "l-bracket" && part.object_id != "flange" &&
           part.object_id != "handle";
  });
  const auto scenes = rendering::PlanRandomScenes(parts_, {.stand = {}, .count = 12, .seed = 21});
  ASSERT_THAT(scenes, IsOk());
  scenes_ = *scenes;
  v1::Cell cell;
  *cell.mutable_sensor_pose() = files::ToMessage(scenes_[0].world_sensor);
  *cell.mutable_robot_base_pose() = files::ToMessage(WorldBase());
  std::string json;
  ASSERT_TRUE(google::protobuf::util::MessageToJsonString(cell, &json).ok());
  std::ofstream(Path("cell.json")) << json;
  Succeed({"cells", "set", "press-3", "--from", Path("cell.json"), "--region",
           "-0.3,-0.3,-0.02,0.3,0.3,0.4"});
}

void CellProgramsTest::StartAgent(const std::vector<std::string>& flags) {
  StartAgentWith(absl::StrCat("simulated:scene=", Path(scene_)), flags);
}

void CellProgramsTest::StartAgentWith(const std::string& sensor,
                                      const std::vector<std::string>& flags,
                                      const std::vector<std::string>& environment) {
  std::vector<std::string> command = {
      GRASPDB_CELL_PROGRAM, "--cell",   "press-3",     "--server",      address_,
      "--sensor",           sensor,     "--gri",       "127.0.0.1:0",   "--line",
      "127.0.0.1:0",        "--health", "127.0.0.1:0", "--cell-period", "0.1"};
  command.insert(command.end(), flags.begin(), flags.end());
  if (!environment.empty()) {
    command.insert(command.begin(), environment.begin(), environment.end());
    command.insert(command.begin(), "/usr/bin/env");
  }
  agent_ = std::make_unique<Process>(folder_.path(), command);
  gri_ = agent_->WaitForLine("GRI on ");
  ASSERT_NE(gri_, "") << agent_->Errors();
}

const rendering::PlannedCapture& CellProgramsTest::LayOut(std::size_t scene) {
  shown_ = scenes_.at(scene);
  EXPECT_THAT(rendering::WriteScenes(Path(scene_), parts_, {shown_}), IsOk());
  return shown_;
}

client::GriClient CellProgramsTest::Robot() const {
  const auto address = ParseListenAddress("gri", gri_);
  auto robot = client::GriClient::Connect(address->host, address->port, std::chrono::minutes(1));
  EXPECT_THAT(robot, IsOk());
  return *std::move(robot);
}

GriRequest CellProgramsTest::Request(GriAction action, int job) {
  GriRequest out;
  out.action = static_cast<std::uint8_t>(action);
  out.job_id = static_cast<std::uint16_t>(job);
  return out;
}

GriResponse CellProgramsTest::Trigger(client::GriClient& robot, int job) const {
  const auto answer = robot.Call(Request(GriAction::kTriggerJobSync, job));
  EXPECT_THAT(answer, IsOk());
  return answer.value_or(GriResponse());
}

void CellProgramsTest::AwaitCode(GriCode code, int job) const {
  client::GriClient robot = Robot();
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  GriCode last = GriCode::kUnknownError;
  while (std::chrono::steady_clock::now() < end) {
    last = Trigger(robot, job).code;
    if (last == code) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  ADD_FAILURE() << "the code stays " << static_cast<int>(last) << "\n" << agent_->Errors();
}

void CellProgramsTest::ExpectHolds(const GriResponse& answer) const { ExpectHolds(answer, shown_); }

void CellProgramsTest::ExpectHolds(const GriResponse& answer,
                                   const rendering::PlannedCapture& scene) const {
  ASSERT_EQ(answer.code, GriCode::kNoError) << agent_->Errors();
  const auto base_tcp = client::FromGriPose(answer.pose, answer.pose_format);
  ASSERT_THAT(base_tcp, IsOk());
  const lab::PickError error = lab::JudgePick(parts_, scene, WorldBase() * *base_tcp);
  EXPECT_EQ(error.object, parts_[scene.placements[0].part].object_id);
  EXPECT_TRUE(lab::WouldHold(error)) << 1000 * error.shift_m << " mm, " << error.turn_rad << " rad";
}

bool CellProgramsTest::Holds(const GriResponse& answer,
                             const rendering::PlannedCapture& scene) const {
  if (answer.code != GriCode::kNoError) return false;
  const auto base_tcp = client::FromGriPose(answer.pose, answer.pose_format);
  return base_tcp.ok() && lab::WouldHold(lab::JudgePick(parts_, scene, WorldBase() * *base_tcp));
}

}  // namespace graspdb::end_to_end
