#include "client/cell/calibration/hand_eye.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <numbers>
#include <random>

#include "recognition/base/units.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;
using graspdb::testing::IsOk;
using graspdb::testing::StatusIs;
using recognition::Pose;
using ::testing::AllOf;
using ::testing::HasSubstr;

Pose PoseOf(const Vector3d& at, double angle, const Vector3d& axis) {
  Pose out = Pose::Identity();
  out.translation() = at;
  out.linear() = AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  return out;
}

double ShiftBetween(const Pose& a, const Pose& b) {
  return (a.translation() - b.translation()).norm();
}

double TurnBetween(const Pose& a, const Pose& b) {
  return AngleAxisd(a.linear().transpose() * b.linear()).angle();
}

// Root mean square error of `found` at the target positions, where errors of the camera's position
// and of its rotation, a metre away, compensate each other.
double ErrorAtTarget(const std::vector<HandEyeSample>& seen, const Pose& found, const Pose& truth) {
  double squares = 0;
  for (const HandEyeSample& sample : seen) {
    const Vector3d at = sample.camera_target.translation();
    squares += (found * at - truth * at).squaredNorm();
  }
  return std::sqrt(squares / static_cast<double>(seen.size()));
}

// A cell with known ground truth, and its robot.
class Cell {
 public:
  Cell(CameraMount mount, std::uint64_t seed)
      : camera(mount == CameraMount::kFixed ? PoseOf({0.6, 0.1, 1.2}, 2.8, {1, 0.1, 0.05})
                                            : PoseOf({0.06, -0.02, 0.05}, 0.2, {1, 0.5, 0.3})),
        target(mount == CameraMount::kFixed ? PoseOf({0.02, -0.03, 0.12}, 0.7, {0.2, 0.5, 1})
                                            : PoseOf({0.5, 0.05, 0}, 0.7, {0, 0, 1})),
        mount_(mount),
        random_(seed) {}

  // `tilt_rad`: maximum tilt of the tool from pointing down, about a random horizontal axis.
  std::vector<HandEyeSample> Drive(int poses, double tilt_rad, double shift_noise_m = 0,
                                   double turn_noise_rad = 0) {
    std::vector<HandEyeSample> out;
    for (int i = 0; i < poses; ++i) {
      const double heading = 2 * std::numbers::pi * Uniform();
      const Vector3d axis(std::cos(heading), std::sin(heading), 0);
      const Vector3d at(0.5 + 0.15 * Uniform(), 0.15 * Uniform(), 0.4 + 0.1 * Uniform());
      const Pose base_flange =
          PoseOf(at, tilt_rad * Uniform(), axis) *
          PoseOf(Vector3d::Zero(), std::numbers::pi, Vector3d::UnitX()) *
          PoseOf(Vector3d::Zero(), std::numbers::pi * Uniform(), Vector3d::UnitZ());
      HandEyeSample sample;
      sample.camera_target = mount_ == CameraMount::kFixed
                                 ? camera.inverse() * base_flange * target
                                 : camera.inverse() * base_flange.inverse() * target;
      sample.base_flange = base_flange * Noise(shift_noise_m, turn_noise_rad);
      sample.camera_target = sample.camera_target * Noise(shift_noise_m, turn_noise_rad);
      out.push_back(sample);
    }
    return out;
  }

  Pose Noise(double shift_m, double turn_rad) {
    return PoseOf(shift_m * Normals(), turn_rad * Normals().norm(), Normals());
  }

  const Pose camera;  // over the table pointing down, or beside the tool
  const Pose target;  // in the gripper, or on the table

 private:
  double Uniform() { return std::uniform_real_distribution<double>(-1, 1)(random_); }
  Vector3d Normals() {
    std::normal_distribution<double> normal;
    const double x = normal(random_);
    const double y = normal(random_);
    return {x, y, normal(random_)};
  }

  CameraMount mount_;
  std::mt19937_64 random_;
};

class HandEyeTest : public ::testing::TestWithParam<CameraMount> {};

TEST_P(HandEyeTest, IsExactWithoutNoise) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Cell cell(GetParam(), seed);
    const auto found = SolveHandEye(cell.Drive(8, 0.5), GetParam());
    ASSERT_THAT(found, IsOk());
    EXPECT_LT(ShiftBetween(found->mount_camera, cell.camera), 1e-9);
    EXPECT_LT(TurnBetween(found->mount_camera, cell.camera), 1e-7);
    EXPECT_LT(ShiftBetween(found->mount_target, cell.target), 1e-9);
    EXPECT_LT(found->shift_m, 1e-9);
  }
}

TEST_P(HandEyeTest, TwelveNoisyPosesAreAccurateToAMillimetreAndAHalf) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Cell cell(GetParam(), seed);
    const auto samples = cell.Drive(12, 0.8, 0.0003, 0.12 * recognition::kRadiansPerDegree);
    const auto found = SolveHandEye(samples, GetParam());
    ASSERT_THAT(found, IsOk());
    EXPECT_LT(ErrorAtTarget(samples, found->mount_camera, cell.camera), 0.0015) << seed;
    EXPECT_LT(TurnBetween(found->mount_camera, cell.camera), 0.3 * recognition::kRadiansPerDegree)
        << seed;
    EXPECT_GT(found->shift_m, 0.0002) << "the residuals must not hide the noise";
    EXPECT_LT(found->shift_m, 0.002);
  }
}

TEST_P(HandEyeTest, OutliersAreLeftOutAndReported) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Cell cell(GetParam(), seed);
    std::vector<HandEyeSample> samples =
        cell.Drive(12, 0.8, 0.0003, 0.1 * recognition::kRadiansPerDegree);
    // A half turn of a nearly symmetric part, and a shifted part.
    samples[3].camera_target =
        samples[3].camera_target * PoseOf(Vector3d::Zero(), std::numbers::pi, Vector3d::UnitZ());
    samples[7].camera_target.translation().x() += 0.05;
    const auto found = SolveHandEye(samples, GetParam());
    ASSERT_THAT(found, IsOk());
    for (std::size_t i = 0; i < samples.size(); ++i) {
      EXPECT_EQ(found->residuals[i].used, i != 3 && i != 7) << "sample " << i << ", seed " << seed;
    }
    EXPECT_GT(found->residuals[3].turn_rad, 3);
    samples.erase(samples.begin() + 7);
    EXPECT_LT(ErrorAtTarget(samples, found->mount_camera, cell.camera), 0.0015);
    EXPECT_LT(TurnBetween(found->mount_camera, cell.camera), 0.3 * recognition::kRadiansPerDegree);
  }
}

TEST_P(HandEyeTest, SimilarPosesAreRejected) {
  Cell cell(GetParam(), 1);
  // Turns about the vertical alone leave the camera's height undetermined.
  EXPECT_THAT(SolveHandEye(cell.Drive(12, 0), GetParam()),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("too similar")));
  EXPECT_THAT(SolveHandEye(cell.Drive(12, 3 * recognition::kRadiansPerDegree), GetParam()),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("tilt")));
  const std::vector<HandEyeSample> one(12, cell.Drive(1, 0.5).front());
  EXPECT_THAT(SolveHandEye(one, GetParam()), StatusIs(absl::StatusCode::kFailedPrecondition));
}

TEST_P(HandEyeTest, TooFewPosesAreRejected) {
  Cell cell(GetParam(), 1);
  for (int poses = 0; poses < static_cast<int>(kMinHandEyeSamples); ++poses) {
    EXPECT_THAT(SolveHandEye(cell.Drive(poses, 0.5), GetParam()),
                StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("at least 6")));
  }
}

TEST_P(HandEyeTest, TooFewInliersAreReported) {
  Cell cell(GetParam(), 1);
  std::vector<HandEyeSample> samples = cell.Drive(8, 0.5);
  for (const std::size_t i : {1U, 4U, 6U}) samples[i].camera_target = cell.Noise(0.3, 1);
  EXPECT_THAT(SolveHandEye(samples, GetParam()), StatusIs(absl::StatusCode::kFailedPrecondition,
                                                          HasSubstr("only 5 of 8 poses agree")));
}

TEST_P(HandEyeTest, InconsistentDetectionsAreRejected) {
  Cell cell(GetParam(), 1);
  std::vector<HandEyeSample> samples = cell.Drive(12, 0.5);
  for (HandEyeSample& sample : samples) sample.camera_target = cell.Noise(0.3, 1);
  EXPECT_THAT(SolveHandEye(samples, GetParam()),
              StatusIs(absl::StatusCode::kFailedPrecondition,
                       AllOf(HasSubstr("agree"), HasSubstr("base frame"))));
}

TEST_P(HandEyeTest, CheckReturnsTheErrorOfAnExistingCalibration) {
  Cell cell(GetParam(), 1);
  const std::vector<HandEyeSample> samples = cell.Drive(5, 0.5);
  for (const HandEyeResidual& r : CheckHandEye(samples, GetParam(), cell.camera, cell.target)) {
    EXPECT_LT(r.shift_m, 1e-9);
  }
  Pose pushed = cell.camera;
  pushed.translation().x() += 0.004;
  for (const HandEyeResidual& r : CheckHandEye(samples, GetParam(), pushed, cell.target)) {
    EXPECT_NEAR(r.shift_m, 0.004, 1e-9);
    EXPECT_LT(r.turn_rad, 1e-7);
  }
}

INSTANTIATE_TEST_SUITE_P(Mounts, HandEyeTest,
                         ::testing::Values(CameraMount::kFixed, CameraMount::kOnFlange));

}  // namespace
}  // namespace graspdb::client
