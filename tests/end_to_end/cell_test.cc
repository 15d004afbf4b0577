// A robot cell end to end: camera, agent, server and robot as separate processes.
#include <gmock/gmock.h>
#include <signal.h>

#include <filesystem>

#include "absl/time/clock.h"
#include "client/cell/sensors/kinect/fakenect_recording.h"
#include "client/cell/sensors/kinect/kinect_v1_calibration.h"
#include "rendering/camera/depth_camera.h"
#include "rendering/simulation.h"
#include "tests/end_to_end/fixtures/cell_fixture.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::end_to_end {
namespace {

using client::GriAction;
using client::GriCode;
using client::GriResponse;
using ::testing::HasSubstr;
using testing::IsOk;

TEST_F(CellProgramsTest, ReturnsGraspsOfVisibleObjects) {
  StartCell();
  StartAgent();
  client::GriClient robot = Robot();
  for (std::size_t scene = 0; scene < 12; ++scene) {
    LayOut(scene);
    ExpectHolds(Trigger(robot));
  }
}

TEST_F(CellProgramsTest, ReturnsTheObjectPoseOfTheGrasp) {
  StartCell();
  StartAgent();
  client::GriClient robot = Robot();
  const rendering::PlannedCapture& scene = LayOut(0);
  ASSERT_EQ(Trigger(robot).code, GriCode::kNoError);
  const auto related = robot.Call(Request(GriAction::kGetRelatedPose));
  ASSERT_THAT(related, IsOk());
  const auto base_object = client::FromGriPose(related->pose, related->pose_format);
  ASSERT_THAT(base_object, IsOk());
  const Eigen::Vector3d off =
      (WorldBase() * *base_object).translation() - scene.placements[0].world_object.translation();
  EXPECT_LT(off.norm(), 0.003);
}

TEST_F(CellProgramsTest, FindsNoPoseWithoutObjects) {
  StartCell();
  StartAgent();
  client::GriClient robot = Robot();
  LayOut(0);
  Succeed({"objects", "delete", "l-bracket", "--force"});
  Succeed({"objects", "delete", "flange", "--force"});
  Succeed({"objects", "delete", "handle", "--force"});
  EXPECT_EQ(Trigger(robot).code, GriCode::kNoPosesFound);
}

TEST_F(CellProgramsTest, LogsAKilledServerAndReconnects) {
  StartCell();
  LayOut(0);
  StartAgent({"--job", "1 any limit=300ms", "--job", "2 any limit=30s"});
  client::GriClient robot = Robot();
  ExpectHolds(Trigger(robot, 2));
  const std::string address = address_;
  server_->Signal(SIGKILL);
  server_->Wait();
  EXPECT_EQ(Trigger(robot).code, GriCode::kApiNotReachable);
  // A job with a longer time limit waits for the server, which starts meanwhile.
  ASSERT_THAT(robot.Call(Request(GriAction::kTriggerJobAsync, 2)), IsOk());
  server_ = std::make_unique<Process>(folder_.path(), ServerCommand(Path("db"), address));
  ASSERT_NE(server_->WaitForLine("listening on "), "") << server_->Errors();
  GriResponse next;
  do {
    next = *robot.Call(Request(GriAction::kGetNextPose, 2));
  } while (next.code == GriCode::kJobStillRunning);
  ExpectHolds(next);
}

TEST_F(CellProgramsTest, LogsAnUnpluggedCameraAndReconnects) {
  StartCell();
  LayOut(0);
  StartAgent({"--job", "1 any limit=300ms", "--job", "2 any limit=30s"});
  client::GriClient robot = Robot();
  ExpectHolds(Trigger(robot, 2));
  std::filesystem::remove_all(Path(scene_));
  EXPECT_EQ(Trigger(robot).code, GriCode::kPipelineNotAvailable);
  LayOut(1);
  ExpectHolds(Trigger(robot, 2));
}

TEST_F(CellProgramsTest, ToleratesARobotThatDisconnectsDuringAJob) {
  StartCell();
  StartAgent({"--job", "1 any", "--job", "2 any limit=1s"});
  {
    client::GriClient gone = Robot();  // no scene yet: the job waits for the camera
    ASSERT_THAT(gone.Call(Request(GriAction::kTriggerJobAsync, 2)), IsOk());
  }
  LayOut(2);
  client::GriClient robot = Robot();
  ExpectHolds(Trigger(robot));
}

TEST_F(CellProgramsTest, StartsBeforeItsServerAndCamera) {
  StartCell();
  server_->Signal(SIGTERM);
  server_->Wait();
  StartAgent({"--job", "1 any limit=300ms", "--job", "2 any limit=30s"});
  client::GriClient robot = Robot();
  EXPECT_EQ(robot.Call(Request(GriAction::kStatus))->data[1], 0);
  EXPECT_EQ(Trigger(robot).code, GriCode::kApiNotReachable);
  server_ = std::make_unique<Process>(folder_.path(), ServerCommand(Path("db"), address_));
  ASSERT_NE(server_->WaitForLine("listening on "), "") << server_->Errors();
  AwaitCode(GriCode::kPipelineNotAvailable);
  LayOut(0);
  AwaitCode(GriCode::kNoError, 2);
}

TEST_F(CellProgramsTest, SimulatedRobotJudgesTheGrasps) {
  StartCell();
  LayOut(0);
  StartAgent();
  const Finished picks =
      Graspdb({"robot", "--cell", "press-3", "--agent", gri_, "--scene", Path(scene_), "--parts",
               "l-bracket,flange,handle", "--picks", "6", "--min-percent", "80"});
  EXPECT_EQ(picks.exit_status, 0) << picks.out << picks.err;
  EXPECT_THAT(picks.out, HasSubstr(" of 6 picks would have held"));
}

TEST_F(CellProgramsTest, SimulatedRobotPrintsJsonWithoutPoses) {
  StartCell();
  LayOut(0);
  StartAgent({"--job", "1 object=no-such-object", "--job", "2 any"});
  const std::vector<std::string> robot = {"robot",     "--cell",  "press-3",    "--agent",
                                          gri_,        "--scene", Path(scene_), "--parts",
                                          "l-bracket", "--picks", "2"};
  const Finished none = Succeed(robot);
  EXPECT_THAT(none.out, HasSubstr("0 of 2 picks would have held (0.0 %); no pose was given"));
  std::vector<std::string> as_json = robot;
  as_json.insert(as_json.end(), {"--json", "--job", "2"});
  const Finished json = Succeed(as_json);
  EXPECT_EQ(CountLines(json.out), 3);
  EXPECT_THAT(json.out, HasSubstr("\"code\":\"NO_ERROR\""));
  EXPECT_THAT(json.out, HasSubstr("\"picks\":2"));
  std::vector<std::string> report_jobs = robot;
  report_jobs.insert(report_jobs.end(), {"--job", "2", "--picked-job", "99", "--missed-job", "99"});
  const Finished refused = Graspdb(report_jobs);
  EXPECT_EQ(refused.exit_status, 1) << refused.out;
  EXPECT_THAT(refused.err, HasSubstr("JOB_DOES_NOT_EXIST"));
  agent_.reset();
  EXPECT_EQ(Graspdb(robot).exit_status, 1) << "the server is available";
}

TEST_F(CellProgramsTest, LogsItsCountersOnStop) {
  StartCell();
  LayOut(0);
  StartAgent();
  client::GriClient robot = Robot();
  ExpectHolds(Trigger(robot));
  agent_->Signal(SIGTERM);
  const Finished done = agent_->Wait();
  EXPECT_EQ(done.exit_status, 0);
  EXPECT_THAT(done.err, HasSubstr("event=counters jobs=1 with_pose=1"));
}

TEST_F(CellProgramsTest, ReadsARecordedKinectThroughLibfreenect) {
  const std::string library = GRASPDB_FAKENECT_LIBRARY;
  if (library.empty()) {
    GTEST_SKIP() << "libfreenect came without fakenect; install Debian's libfreenect-dev";
  }
  StartCell();
  auto recording = client::FakenectRecording::Create(Path("kinect"));
  ASSERT_THAT(recording, IsOk());
  const auto camera = rendering::DepthCamera::Create(client::SimulatedKinectV1());
  ASSERT_THAT(camera, IsOk());
  const auto frame_of = [&](std::size_t scene) {
    const rendering::PlannedCapture& shown = SceneNo(scene);
    return *camera->Render(rendering::SceneOf(parts_, shown, /*with_table=*/true),
                           shown.world_sensor, shown.seed);
  };
  ASSERT_THAT(recording->Show(frame_of(0), absl::Seconds(8)), IsOk());
  ASSERT_THAT(recording->PullOut(), IsOk());
  ASSERT_THAT(recording->Show(frame_of(1), absl::Seconds(120)), IsOk());
  ASSERT_THAT(recording->Finish(), IsOk());

  StartAgentWith("freenect", {"--job", "1 any limit=100ms", "--job", "2 any limit=30s"},
                 {"LD_LIBRARY_PATH=" + std::filesystem::path(library).parent_path().string(),
                  "FAKENECT_PATH=" + Path("kinect")});
  client::GriClient robot = Robot();
  ExpectHolds(Trigger(robot, 2), SceneNo(0));
  // Then it is pulled out, and plugged in again before another scene.
  bool was_gone = false;
  GriResponse answer;
  const absl::Time end = absl::Now() + absl::Seconds(60);
  while (!Holds(answer, SceneNo(1)) && absl::Now() < end) {
    answer = Trigger(robot, was_gone ? 2 : 1);
    was_gone = was_gone || answer.code == GriCode::kPipelineNotAvailable;
  }
  EXPECT_TRUE(was_gone);
  ExpectHolds(answer, SceneNo(1));
}

TEST_F(CellProgramsTest, KeepsAndReplaysFailedRequests) {
  StartCell();
  LayOut(0);
  StartAgent({"--black-box", Path("box"), "--job", "1 any", "--job", "2 object=no-such-object"});
  client::GriClient robot = Robot();
  EXPECT_EQ(Trigger(robot, 2).code, GriCode::kNoPosesFound);
  agent_->Signal(SIGTERM);
  ASSERT_EQ(agent_->Wait().exit_status, 0);
  const Finished same = Graspdb({"replay", Path("box")});
  EXPECT_EQ(same.exit_status, 0) << same.out << same.err;
  Succeed({"objects", "delete", parts_[SceneNo(0).placements[0].part].object_id, "--force"});
  const Finished different = Graspdb({"replay", Path("box")});
  EXPECT_EQ(different.exit_status, 1) << different.out << different.err;
}

TEST_F(CellProgramsTest, NamesTheFlagOfAPortThatIsTaken) {
  StartServer();
  const std::vector<std::string> flags = {"--gri", "--line", "--health"};
  for (const std::string& taken : flags) {
    std::vector<std::string> words = {GRASPDB_CELL_PROGRAM, "--cell", "c", "--sensor", "simulated"};
    for (const std::string& flag : flags) {
      words.push_back(flag);
      words.push_back(flag == taken ? address_ : "127.0.0.1:0");
    }
    const Finished outcome = RunProgram(folder_.path(), words);
    EXPECT_EQ(outcome.exit_status, 1) << taken;
    EXPECT_THAT(outcome.err, HasSubstr("is the port in use? Choose another " + taken));
  }
}

TEST_F(CellProgramsTest, ReportsWrongSettings) {
  const auto run = [&](std::vector<std::string> words) {
    words.insert(words.begin(), GRASPDB_CELL_PROGRAM);
    return RunProgram(folder_.path(), words);
  };
  EXPECT_EQ(run({"--cell", "c"}).exit_status, 2);
  const Finished job = run({"--cell", "c", "--sensor", "simulated", "--job", "1 objekt=mug"});
  EXPECT_EQ(job.exit_status, 2);
  EXPECT_THAT(job.err, HasSubstr("objekt"));
  const Finished remote = run({"--cell", "c", "--sensor", "simulated", "--gri", "0.0.0.0:0"});
  EXPECT_EQ(remote.exit_status, 1);
  EXPECT_THAT(remote.err, HasSubstr("--allow-remote-robots"));
  const Finished sensor = run({"--cell", "c", "--sensor", "polaroid"});
  EXPECT_NE(sensor.exit_status, 0);
  EXPECT_THAT(sensor.err, HasSubstr("freenect"));
  const Finished server = run({"--cell", "c", "--sensor", "simulated", "--server", "localhost"});
  EXPECT_EQ(server.exit_status, 2);
  EXPECT_THAT(server.err, HasSubstr("--server localhost is not HOST:PORT"));
  const Finished token =
      run({"--cell", "c", "--sensor", "simulated", "--token-file", Path("none")});
  EXPECT_EQ(token.exit_status, 1);
  EXPECT_THAT(token.err, HasSubstr("none (No such file or directory)"));
}

}  // namespace
}  // namespace graspdb::end_to_end
