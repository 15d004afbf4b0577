#include "client/cell/calibration/hand_eye.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <functional>
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

TEST_P(HandEyeTest, CertaintyIsOfTheSizeOfTheNoise) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Cell cell(GetParam(), seed);
    const auto samples = cell.Drive(12, 0.8, 0.0003, 0.12 * recognition::kRadiansPerDegree);
    const auto found = SolveHandEye(samples, GetParam());
    ASSERT_THAT(found, IsOk());
    const HandEyeCertainty& certainty = found->certainty;
    EXPECT_GE(certainty.left_out_shift_m, found->shift_m) << seed;
    EXPECT_LT(certainty.left_out_shift_m, 0.006) << seed;
    EXPECT_LT(certainty.left_out_turn_rad, 0.01) << seed;
    EXPECT_GT(certainty.weakest_m, 0.0002) << seed;
    EXPECT_LT(certainty.weakest_m, 0.008) << seed;
    EXPECT_LT(ShiftBetween(found->mount_camera, cell.camera), 5 * certainty.weakest_m) << seed;
  }
}

std::vector<HandEyeSample> Scaled(std::vector<HandEyeSample> samples, double factor) {
  for (HandEyeSample& sample : samples) sample.base_flange.translation() *= factor;
  return samples;
}

TEST_P(HandEyeTest, PositionsInAnotherUnitAreRefused) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Cell cell(GetParam(), seed);
    const auto samples = cell.Drive(9, 0.5, 0.0003, 0.1 * recognition::kRadiansPerDegree);
    for (const double factor : {0.001, 1000.0}) {  // metres for millimetres, and back
      EXPECT_THAT(SolveHandEye(Scaled(samples, factor), GetParam()),
                  StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("metres")))
          << factor;
    }
    for (const double factor : {0.01, 0.1, 1 / 25.4, 10.0}) {  // decimetres, centimetres, inches
      EXPECT_THAT(SolveHandEye(Scaled(samples, factor), GetParam()),
                  StatusIs(absl::StatusCode::kFailedPrecondition,
                           ::testing::AnyOf(HasSubstr("unit"), HasSubstr("metres"))))
          << factor;
    }
  }
}

// Poses as other programs have sent them.
TEST_P(HandEyeTest, PosesInAnotherFormatAreRefused) {
  const auto inverse = [](const Pose& pose) { return pose.inverse(); };
  const auto w_first = [](const Pose& pose) {
    const Eigen::Quaterniond q(pose.linear());
    Pose out = pose;
    out.linear() = Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y()).toRotationMatrix();
    return out;
  };
  const auto other_order = [](const Pose& pose) {  // Euler's angles about x, y, z as of z, y, x
    const Vector3d angles = pose.linear().eulerAngles(0, 1, 2);
    Pose out = pose;
    out.linear() =
        (AngleAxisd(angles[2], Vector3d::UnitZ()) * AngleAxisd(angles[1], Vector3d::UnitY()) *
         AngleAxisd(angles[0], Vector3d::UnitX()))
            .toRotationMatrix();
    return out;
  };
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Cell cell(GetParam(), seed);
    const auto good = cell.Drive(10, 0.6, 0.0003, 0.1 * recognition::kRadiansPerDegree);
    for (const std::function<Pose(const Pose&)>& format :
         {std::function<Pose(const Pose&)>(inverse), std::function<Pose(const Pose&)>(w_first),
          std::function<Pose(const Pose&)>(other_order)}) {
      std::vector<HandEyeSample> samples = good;
      for (HandEyeSample& sample : samples) sample.base_flange = format(sample.base_flange);
      EXPECT_THAT(SolveHandEye(samples, GetParam()),
                  StatusIs(absl::StatusCode::kFailedPrecondition));
    }
    // One detection failed, and each later one is paired with the pose before it.
    std::vector<HandEyeSample> samples = good;
    for (std::size_t i = 3; i < samples.size(); ++i) {
      samples[i - 1].camera_target = good[i].camera_target;
    }
    EXPECT_THAT(SolveHandEye(samples, GetParam()),
                StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("agree")));
  }
}

TEST_P(HandEyeTest, HalfTurnsAndRepeatedPosesDoNoHarm) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Cell cell(GetParam(), seed);
    auto samples = cell.Drive(8, 0.5);
    samples.insert(samples.end(), 4, samples.front());
    const Pose half_turn = PoseOf(Vector3d::Zero(), std::numbers::pi, Vector3d::UnitZ());
    HandEyeSample turned = samples[1];
    turned.base_flange = turned.base_flange * half_turn;
    turned.camera_target = GetParam() == CameraMount::kFixed
                               ? cell.camera.inverse() * turned.base_flange * cell.target
                               : cell.camera.inverse() * turned.base_flange.inverse() * cell.target;
    samples.push_back(turned);
    const auto found = SolveHandEye(samples, GetParam());
    ASSERT_THAT(found, IsOk());
    EXPECT_LT(ShiftBetween(found->mount_camera, cell.camera), 1e-8);
  }
}

TEST_P(HandEyeTest, ARobotThatTurnsInPlaceOrDoesNotTurnIsRefused) {
  Cell cell(GetParam(), 1);
  auto samples = cell.Drive(10, 0.6);
  for (HandEyeSample& sample : samples) {
    sample.base_flange.translation() = Vector3d(0.5, 0, 0.4);
    sample.camera_target = GetParam() == CameraMount::kFixed
                               ? cell.camera.inverse() * sample.base_flange * cell.target
                               : cell.camera.inverse() * sample.base_flange.inverse() * cell.target;
  }
  EXPECT_THAT(SolveHandEye(samples, GetParam()),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("hardly moves")));
  samples = cell.Drive(10, 0.6);
  for (HandEyeSample& sample : samples) sample.base_flange.linear().setIdentity();
  EXPECT_THAT(SolveHandEye(samples, GetParam()),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("too similar")));
}

// The camera is always at the same distance from the target, and looks at it.
class HandEyeOnASphereTest : public ::testing::Test {
 protected:
  std::vector<HandEyeSample> Drive(int poses, std::uint64_t seed, double shift_noise_m,
                                   double turn_noise_rad) const {
    Cell noise(CameraMount::kOnFlange, seed);
    std::vector<HandEyeSample> samples;
    for (int i = 0; i < poses; ++i) {
      HandEyeSample sample;
      sample.camera_target = PoseOf({0, 0, 0.6}, std::numbers::pi, {1, 0, 0}) *
                             PoseOf({0, 0, 0}, 0.3 + 0.1 * (i % 3), {std::cos(i), std::sin(i), 0}) *
                             PoseOf({0, 0, 0}, 2.1 * i, {0, 0, 1});
      sample.base_flange = PoseOf({0.5, 0.1, 0}, 0.6, {0, 0, 1}) * sample.camera_target.inverse() *
                           camera_.inverse();
      sample.camera_target = sample.camera_target * noise.Noise(shift_noise_m, turn_noise_rad);
      samples.push_back(sample);
    }
    return samples;
  }

  const Pose camera_ = PoseOf({0.04, -0.01, 0.06}, 0.8, {0, 0, 1});
};

TEST_F(HandEyeOnASphereTest, GoodPositionsAreAcceptedInSpiteOfNoise) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const auto found = SolveHandEye(Drive(20, seed, 0.004, 0.004), CameraMount::kOnFlange);
    ASSERT_THAT(found, IsOk()) << seed;
    EXPECT_LT(ShiftBetween(found->mount_camera, camera_), 0.02) << seed;
  }
}

TEST_F(HandEyeOnASphereTest, PositionsInMetresForMillimetresAreRefused) {
  const std::vector<HandEyeSample> samples = Drive(9, 1, 0, 0);
  const auto found = SolveHandEye(samples, CameraMount::kOnFlange);
  ASSERT_THAT(found, IsOk());
  EXPECT_LT(ShiftBetween(found->mount_camera, camera_), 1e-6);
  for (const double factor : {0.001, 1 / 25.4, 1000.0}) {
    EXPECT_THAT(SolveHandEye(Scaled(samples, factor), CameraMount::kOnFlange),
                StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("millimetres")))
        << factor;
  }
}

INSTANTIATE_TEST_SUITE_P(Mounts, HandEyeTest,
                         ::testing::Values(CameraMount::kFixed, CameraMount::kOnFlange));

}  // namespace
}  // namespace graspdb::client
