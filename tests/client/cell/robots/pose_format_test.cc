#include "client/cell/robots/pose_format.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using graspdb::testing::IsOk;
using graspdb::testing::StatusIs;
using recognition::Pose;
using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kPi = std::numbers::pi;

Pose PoseOf(const Matrix3d& rotation) {
  Pose out = Pose::Identity();
  out.linear() = rotation;
  out.translation() << 0.1, -0.2, 1.5;
  return out;
}

Matrix3d RandomRotation(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const Vector3d xyz(normal(random), normal(random), normal(random));
  return Quaterniond(normal(random), xyz.x(), xyz.y(), xyz.z()).normalized().toRotationMatrix();
}

// The rotation defined by the interface's documentation.
Matrix3d RotationInWords(const std::array<double, 4>& n, const std::string& sequence, bool backward,
                         bool radians) {
  Matrix3d out = Matrix3d::Identity();
  for (std::size_t turn = 0; turn < 3; ++turn) {
    const double number = n[backward ? 2 - turn : turn];
    const double angle = radians ? number : number * kPi / 180;
    out *= AngleAxisd(angle, Vector3d::Unit(sequence[turn] - 'X')).toRotationMatrix();
  }
  return out;
}

class PoseFormatTest : public ::testing::TestWithParam<int> {
 protected:
  // The expected rotation, by Eigen's own classes.
  static Matrix3d Meaning(const std::array<double, 4>& n) {
    const int code = GetParam();
    if (code == 1) return Quaterniond(n[0], n[1], n[2], n[3]).toRotationMatrix();
    if (code == 2) return Quaterniond(n[3], n[0], n[1], n[2]).toRotationMatrix();
    if (code == 3) {
      const Vector3d v(n[0], n[1], n[2]);
      return AngleAxisd(v.norm(), v.stableNormalized()).toRotationMatrix();
    }
    static const std::vector<std::string> sequences = {"XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX",
                                                       "XYX", "XZX", "YXY", "YZY", "ZXZ", "ZYZ"};
    const int s = (code - 4) / 4;
    const int b = (code - 4 - 4 * s) / 2;
    const int r = code - 4 - 4 * s - 2 * b;
    return RotationInWords(n, sequences.at(static_cast<std::size_t>(s)), b == 1, r == 1);
  }

  static void ExpectKept(const Matrix3d& rotation) {
    const auto numbers = ToRobotPose(PoseOf(rotation), GetParam());
    ASSERT_THAT(numbers, IsOk());
    EXPECT_LT((Meaning(numbers->rotation) - rotation).norm(), 1e-8) << rotation;
    const auto back = FromRobotPose(*numbers, GetParam());
    ASSERT_THAT(back, IsOk());
    EXPECT_LT((back->matrix() - PoseOf(rotation).matrix()).norm(), 1e-8) << rotation;
  }
};

TEST_P(PoseFormatTest, MatchesItsDocumentation) {
  std::mt19937_64 random(static_cast<std::uint64_t>(GetParam()));
  for (int i = 0; i < 200; ++i) ExpectKept(RandomRotation(random));
}

TEST_P(PoseFormatTest, SurvivesGimbalLock) {
  for (const double a : {0.0, kPi / 2, kPi, -kPi / 2, 0.3}) {
    for (const double b : {0.0, kPi / 2, kPi, -kPi / 2}) {
      for (const double c : {0.0, kPi / 2, -kPi / 2, -1.1}) {
        ExpectKept((AngleAxisd(a, Vector3d::UnitX()) * AngleAxisd(b, Vector3d::UnitY()) *
                    AngleAxisd(c, Vector3d::UnitZ()))
                       .toRotationMatrix());
      }
    }
  }
}

TEST_P(PoseFormatTest, RejectsNonFiniteNumbers) {
  auto numbers = ToRobotPose(Pose::Identity(), GetParam());
  ASSERT_THAT(numbers, IsOk());
  numbers->rotation[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(FromRobotPose(*numbers, GetParam()), StatusIs(absl::StatusCode::kInvalidArgument));
}

INSTANTIATE_TEST_SUITE_P(All, PoseFormatTest, ::testing::Range(1, 52));

TEST(PoseFormats, MatchVendorConventions) {
  // A tool that points down, turned by 30 degrees about the vertical.
  const Matrix3d rotation =
      (AngleAxisd(kPi / 6, Vector3d::UnitZ()) * AngleAxisd(kPi, Vector3d::UnitX()))
          .toRotationMatrix();
  const auto near = [](double x) { return DoubleNear(x, 1e-9); };
  // Staeubli: Rx Ry Rz, each about the axis as turned.
  EXPECT_THAT(ToRobotPose(PoseOf(rotation), 4)->rotation,
              ElementsAre(near(180), near(0), near(-30), 0));
  // KUKA: A about Z, then B about Y, then C about X.
  EXPECT_THAT(ToRobotPose(PoseOf(rotation), 24)->rotation,
              ElementsAre(near(30), near(0), near(180), 0));
  // FANUC: W, P, R, which are the same backward.
  EXPECT_THAT(ToRobotPose(PoseOf(rotation), 26)->rotation,
              ElementsAre(near(180), near(0), near(30), 0));
  EXPECT_THAT(ToRobotPose(PoseOf(rotation), 4)->position_mm,
              ElementsAre(near(100), near(-200), near(1500)));
}

TEST(PoseFormats, OtherCodesAreRejected) {
  for (const int code : {0, -1, 52, 255}) {
    EXPECT_THAT(ToRobotPose(Pose::Identity(), code),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("1 to 51")));
    EXPECT_THAT(FromRobotPose({}, code), StatusIs(absl::StatusCode::kInvalidArgument));
  }
}

TEST(PoseFormats, AnInvalidQuaternionIsRejected) {
  EXPECT_THAT(FromRobotPose({}, kQuaternionWxyz),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("length")));
  EXPECT_THAT(FromRobotPose({.rotation = {1.001, 0, 0, 0}}, kQuaternionWxyz), IsOk());
}

}  // namespace
}  // namespace graspdb::client
