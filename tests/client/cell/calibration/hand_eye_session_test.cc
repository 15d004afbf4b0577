// The hand-eye calibration with a simulated camera and robot and a real server.
#include "client/cell/calibration/hand_eye_session.h"

#include <gmock/gmock.h>

#include <cstdio>
#include <cstdlib>

#include "client/cell/calibration/calibrated_cell.h"
#include "client/cell/robots/pose_format.h"
#include "files/messages/pose_message.h"
#include "recognition/base/units.h"
#include "tests/client/cell/agent/fake_camera.h"
#include "tests/client/cell/calibration/calibration_server.h"
#include "tests/client/cell/calibration/simulated_cell.h"
#include "tests/rendering/small_kinect.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using graspdb::testing::CalibrationServer;
using graspdb::testing::IsOk;
using graspdb::testing::SimulatedCell;
using graspdb::testing::StatusIs;
using recognition::Pose;
using ::testing::HasSubstr;

constexpr char kPart[] = "stepped-block";
constexpr char kTarget[] = "objects/stepped-block";
constexpr char kSessionCell[] = "cells/press-1";
constexpr int kPoses = 12;

// Error of a calibration against the ground truth.
struct CalibrationError {
  double camera_m = 0;     // of the camera's position
  double at_target_m = 0;  // of points at the target, root mean square
  double turn_rad = 0;
};

HandEyeSetup SetupFor(CameraMount mount) {
  HandEyeSetup out{.cell = kSessionCell, .target = kTarget, .mount = mount};
  if (mount == CameraMount::kFixed) out.region = GrippedRegion(0.3);
  return out;
}

// The program of docs/calibration.md.
Pose DriveProgramPose(SimulatedCell& cell, CameraMount mount, int number) {
  const double tilt = mount == CameraMount::kFixed ? 30 * recognition::kRadiansPerDegree
                                                   : 35 * recognition::kRadiansPerDegree;
  return cell.DriveProgram(number, tilt, 90 * recognition::kRadiansPerDegree);
}

class HandEyeSessionTest : public ::testing::TestWithParam<CameraMount> {
 protected:
  // Shared by all tests; its folder is named after the first.
  void SetUp() override {
    if (shared_server != nullptr) return;
    shared_server = new CalibrationServer;
    shared_server->Teach(kPart, graspdb::testing::SmallKinectV2());
  }
  static void TearDownTestSuite() {
    delete shared_server;
    shared_server = nullptr;
  }
  void TearDown() override { client().DeleteCell(kSessionCell).IgnoreError(); }

  static Client& client() { return shared_server->client(); }
  static void MakeCell(const SimulatedCell& cell) {
    const Pose world_camera = cell.world_camera();
    shared_server->MakeCell("press-1", GetParam() == CameraMount::kFixed ? &world_camera : nullptr);
  }

  // Calibrates with `poses` good poses; `error`: of the saved cell.
  static absl::StatusOr<CalibrationReport> Run(SimulatedCell& cell, int poses,
                                               CalibrationError* error) {
    HandEyeSession session(client(), cell, SetupFor(GetParam()));
    if (absl::Status status = session.Init(); !status.ok()) return status;
    std::vector<Eigen::Vector3d> seen;
    for (int i = 0; i < poses; ++i) {
      const Pose base_flange = DriveProgramPose(cell, GetParam(), i);
      absl::Status status = session.SetPose(i, base_flange);
      // Like a robot's program, continues if the target was not detected.
      if (status.ok()) seen.emplace_back(cell.camera_target().translation());
    }
    auto report = session.Calibrate();
    if (!report.ok()) return report;
    const auto saved = client().GetCell(kSessionCell);
    if (!saved.ok()) return saved.status();
    const auto found = MountCameraOf(*saved);
    if (!found.ok()) return found.status();
    const Pose truth = cell.mount_camera();
    error->camera_m = (found->translation() - truth.translation()).norm();
    error->turn_rad = RotationVector(truth.linear().transpose() * found->linear()).norm();
    double squares = 0;
    for (const Eigen::Vector3d& at : seen) squares += (*found * at - truth * at).squaredNorm();
    error->at_target_m = std::sqrt(squares / static_cast<double>(seen.size()));
    return report;
  }

  static CalibrationServer* shared_server;
};

CalibrationServer* HandEyeSessionTest::shared_server = nullptr;

// More seeds, for the figures of docs/calibration.md.
std::uint64_t Seeds() {
  const char* count = std::getenv("GRASPDB_HAND_EYE_SEEDS");
  return count == nullptr ? 1 : std::strtoull(count, nullptr, 10);
}

TEST_P(HandEyeSessionTest, TwelveNoisyPosesAreAccurateToAMillimetreAndAHalf) {
  for (std::uint64_t seed = 1; seed <= Seeds(); ++seed) {
    SimulatedCell cell(GetParam(), kPart, graspdb::testing::SmallKinectV2(), seed);
    MakeCell(cell);
    CalibrationError error;
    const auto report = Run(cell, kPoses, &error);
    ASSERT_THAT(report, IsOk()) << "seed " << seed;
    std::printf(
        "seed %2d: used %2zu of %zu, residual %.2f mm %.2f deg; error at target %.2f mm, camera "
        "%.2f mm, %.3f deg\n",
        static_cast<int>(seed), report->used, report->poses, 1e3 * report->shift_m,
        report->turn_rad / recognition::kRadiansPerDegree, 1e3 * error.at_target_m,
        1e3 * error.camera_m, error.turn_rad / recognition::kRadiansPerDegree);
    EXPECT_LT(error.at_target_m, 0.0015);
    EXPECT_LT(error.camera_m, 0.0015);
    EXPECT_LT(error.turn_rad, 0.3 * recognition::kRadiansPerDegree);
    EXPECT_GE(report->used, 9U);
    EXPECT_GT(report->shift_m, 0.0001) << "the residuals must not hide the noise";
    EXPECT_THAT(client().DeleteCell(kSessionCell), IsOk());
  }
}

TEST_P(HandEyeSessionTest, SimilarPosesAreRejectedAndTheCellIsUnchanged) {
  SimulatedCell cell(GetParam(), kPart, graspdb::testing::SmallKinectV2(), 3);
  MakeCell(cell);
  const auto before = client().GetCell(kSessionCell);
  HandEyeSession session(client(), cell, SetupFor(GetParam()));
  ASSERT_THAT(session.Init(), IsOk());
  for (int turns = 0; turns < 2; ++turns) {  // shifts alone, and turns about the vertical
    int set = 0;
    for (int i = 0; i < 10 && set < 7; ++i) {
      set += session.SetPose(set, cell.Drive(0, turns * 60 * recognition::kRadiansPerDegree)).ok()
                 ? 1
                 : 0;
    }
    ASSERT_GE(set, 6);
    EXPECT_THAT(session.Calibrate(),
                StatusIs(absl::StatusCode::kNotFound, HasSubstr("too similar")));
  }
  EXPECT_EQ(client().GetCell(kSessionCell)->etag(), before->etag());
}

TEST_P(HandEyeSessionTest, AnUndetectedTargetIsReportedAndKeepsItsSlot) {
  SimulatedCell cell(GetParam(), kPart, graspdb::testing::SmallKinectV2(), 3);
  MakeCell(cell);
  HandEyeSession session(client(), cell, SetupFor(GetParam()));
  ASSERT_THAT(session.Init(), IsOk());
  cell.set_hidden(true);
  EXPECT_THAT(session.SetPose(0, DriveProgramPose(cell, GetParam(), 0)),
              StatusIs(absl::StatusCode::kNotFound, HasSubstr("not recognised")));
  EXPECT_THAT(session.Calibrate(), StatusIs(absl::StatusCode::kNotFound, HasSubstr("0 poses")));
  cell.set_hidden(false);
  absl::Status seen = absl::UnknownError("not driven yet");
  for (int i = 0; i < 5 && !seen.ok(); ++i)
    seen = session.SetPose(0, DriveProgramPose(cell, GetParam(), i));
  ASSERT_THAT(seen, IsOk());
  cell.set_hidden(true);
  EXPECT_THAT(session.SetPose(0, DriveProgramPose(cell, GetParam(), 0)),
              StatusIs(absl::StatusCode::kNotFound, HasSubstr("not recognised")));
  EXPECT_THAT(session.Calibrate(), StatusIs(absl::StatusCode::kNotFound, HasSubstr("1 poses")));
}

// Not of the server, which is there, the target or the robot's request.
TEST_P(HandEyeSessionTest, AFaultOfTheCameraIsReportedAsOne) {
  const SimulatedCell cell(GetParam(), kPart, graspdb::testing::SmallKinectV2(), 3);
  MakeCell(cell);
  absl::Status fault;
  FakeCamera camera([&fault]() -> absl::StatusOr<SensorFrame> { return fault; });
  HandEyeSession session(client(), camera, SetupFor(GetParam()));
  ASSERT_THAT(session.Init(), IsOk());
  for (const auto code : {absl::StatusCode::kUnavailable, absl::StatusCode::kNotFound,
                          absl::StatusCode::kInvalidArgument}) {
    fault = absl::Status(code, "unplugged");
    EXPECT_THAT(session.SetPose(0, Pose::Identity()),
                StatusIs(absl::StatusCode::kDataLoss, HasSubstr("unplugged")));
  }
  fault = absl::DeadlineExceededError("no frame in time");
  EXPECT_THAT(session.SetPose(0, Pose::Identity()),
              StatusIs(absl::StatusCode::kDeadlineExceeded, HasSubstr("in time")));
}

TEST_P(HandEyeSessionTest, CallsBeforeInitAreAborted) {
  SimulatedCell cell(GetParam(), kPart, graspdb::testing::SmallKinectV2(), 3);
  HandEyeSession session(client(), cell, SetupFor(GetParam()));
  EXPECT_THAT(session.SetPose(0, Pose::Identity()), StatusIs(absl::StatusCode::kAborted));
  EXPECT_THAT(session.Calibrate(), StatusIs(absl::StatusCode::kAborted));
}

TEST_P(HandEyeSessionTest, AnInvalidSetupIsRejectedAtOnce) {
  SimulatedCell cell(GetParam(), kPart, graspdb::testing::SmallKinectV2(), 3);
  const auto init = [&](const HandEyeSetup& setup) {
    return HandEyeSession(client(), cell, setup).Init();
  };
  HandEyeSetup setup = SetupFor(GetParam());
  EXPECT_THAT(init(setup), StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("cells set")));
  MakeCell(cell);
  EXPECT_THAT(init(setup), IsOk());
  setup.target = "objects/nothing";
  EXPECT_THAT(init(setup), StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("teach")));
  if (GetParam() == CameraMount::kOnFlange) return;
  ASSERT_THAT(client().DeleteCell(kSessionCell), IsOk());
  shared_server->MakeCell("press-1", nullptr);
  EXPECT_THAT(init(SetupFor(GetParam())),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("cells level")));
}

INSTANTIATE_TEST_SUITE_P(Mounts, HandEyeSessionTest,
                         ::testing::Values(CameraMount::kFixed, CameraMount::kOnFlange),
                         [](const auto& mount) {
                           return mount.param == CameraMount::kFixed ? "Fixed" : "OnFlange";
                         });

TEST(SymmetricTargetTest, IsRejected) {
  CalibrationServer server;
  server.Teach("z-bar", graspdb::testing::SmallKinectV2());
  EXPECT_THAT(LoadTarget(server.client(), "objects/z-bar"),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("without symmetry")));
}

TEST(CellCalibratorTest, HasTheAddedPipelines) {
  CellCalibrator calibrator;
  EXPECT_THAT(calibrator.Check(1), StatusIs(absl::StatusCode::kNotFound));
  CalibrationServer server;
  SimulatedCell cell(CameraMount::kOnFlange, kPart, graspdb::testing::SmallKinectV2(), 1);
  calibrator.Add(
      1, std::make_unique<HandEyeSession>(server.client(), cell, SetupFor(CameraMount::kOnFlange)));
  EXPECT_THAT(calibrator.Check(1), IsOk());
  EXPECT_THAT(calibrator.Check(2), StatusIs(absl::StatusCode::kNotFound));
  EXPECT_THAT(calibrator.Init(1), StatusIs(absl::StatusCode::kFailedPrecondition));
  EXPECT_THAT(calibrator.SetPose(1, 0, Pose::Identity()), StatusIs(absl::StatusCode::kAborted));
}

}  // namespace
}  // namespace graspdb::client
