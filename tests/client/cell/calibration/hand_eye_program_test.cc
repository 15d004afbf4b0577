// The accuracy of the program of docs/calibration.md with the robot's noise alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <vector>

#include "client/cell/calibration/hand_eye.h"
#include "recognition/base/units.h"
#include "tests/client/cell/calibration/simulated_cell.h"
#include "tests/rendering/small_kinect.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using graspdb::testing::IsOk;
using graspdb::testing::SimulatedCell;
using recognition::Pose;

constexpr int kProgramPoses = 12;
constexpr std::uint64_t kRobots = 300;

// Errors of the camera's position, and of points at the target (root mean square); m.
struct ProgramError {
  double camera = 0;
  double at_target = 0;
};

class HandEyeProgramTest : public ::testing::TestWithParam<CameraMount> {
 protected:
  // Calibrates with exact target poses.
  static ProgramError Run(std::uint64_t seed) {
    SimulatedCell cell(GetParam(), "stepped-block", graspdb::testing::SmallKinectV2(), seed);
    const double tilt = GetParam() == CameraMount::kFixed ? 30 * recognition::kRadiansPerDegree
                                                          : 35 * recognition::kRadiansPerDegree;
    std::vector<HandEyeSample> samples;
    for (int i = 0; i < kProgramPoses; ++i) {
      const Pose base_flange = cell.DriveProgram(i, tilt, 90 * recognition::kRadiansPerDegree);
      samples.push_back({base_flange, cell.camera_target()});
    }
    const auto solved = SolveHandEye(samples, GetParam());
    EXPECT_THAT(solved, IsOk()) << "seed " << seed;
    if (!solved.ok()) return {};
    const Pose truth = cell.mount_camera();
    double squares = 0;
    for (const HandEyeSample& sample : samples) {
      const Eigen::Vector3d at = sample.camera_target.translation();
      squares += (solved->mount_camera * at - truth * at).squaredNorm();
    }
    return {.camera = (solved->mount_camera.translation() - truth.translation()).norm(),
            .at_target = std::sqrt(squares / kProgramPoses)};
  }
};

void ExpectWithin(const char* what, std::vector<double> metres, double limit_m) {
  std::ranges::sort(metres);
  std::printf("%s: median %.2f mm, worst of %zu %.2f mm\n", what, 1e3 * metres[metres.size() / 2],
              metres.size(), 1e3 * metres.back());
  EXPECT_LT(metres.back(), limit_m) << what;
}

TEST_P(HandEyeProgramTest, RobotNoiseAloneCausesLessThanAMillimetreAndAHalf) {
  std::vector<double> camera;
  std::vector<double> at_target;
  for (std::uint64_t seed = 1; seed <= kRobots; ++seed) {
    const ProgramError error = Run(seed);
    camera.push_back(error.camera);
    at_target.push_back(error.at_target);
  }
  ExpectWithin("the camera's own place", camera, 0.0015);
  ExpectWithin("at target", at_target, 0.0015);
}

INSTANTIATE_TEST_SUITE_P(Mounts, HandEyeProgramTest,
                         ::testing::Values(CameraMount::kFixed, CameraMount::kOnFlange),
                         [](const auto& mount) {
                           return mount.param == CameraMount::kFixed ? "Fixed" : "OnFlange";
                         });

}  // namespace
}  // namespace graspdb::client
