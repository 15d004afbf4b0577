#include "rendering/pose_error.h"

#include <gtest/gtest.h>

#include <numbers>

#include "rendering/meshes/solid.h"
#include "rendering/sample_parts.h"

namespace graspdb::rendering {
namespace {

using recognition::Pose;

constexpr double kPi = std::numbers::pi;

const Workpiece& Part(const std::string& id) {
  static const std::vector<Workpiece> parts = SampleParts();
  for (const Workpiece& part : parts) {
    if (part.object_id == id) return part;
  }
  ADD_FAILURE() << "no part " << id;
  return parts.front();
}

Pose At(double x, double turn_deg) {
  Pose pose = Pose::Identity();
  pose.translation().x() = x;
  pose.rotate(Eigen::AngleAxisd(turn_deg * kPi / 180, Eigen::Vector3d::UnitZ()));
  return pose;
}

TEST(Measure, FindsTheTurnsThatChangeNothing) {
  EXPECT_EQ(Measure(Part("flange")).turns_rad.size(), 4U);
  EXPECT_EQ(Measure(Part("z-bar")).turns_rad.size(), 2U);
  EXPECT_EQ(Measure(Part("handle")).turns_rad.size(), 1U);
  EXPECT_TRUE(Measure(Part("stepped-shaft")).any_turn);
}

TEST(ErrorOf, IsZeroForTheTruth) {
  const MeasuredShape shape = Measure(Part("handle"));
  const PoseError error = ErrorOf(shape, At(0.1, 30), At(0.1, 30));
  EXPECT_LT(error.add_s_m, 0.0005);  // the distance between the sampled points
  EXPECT_LT(error.hausdorff_m, 0.002);
  EXPECT_LT(error.rotation_rad, 1e-6);
  EXPECT_LT(error.translation_m, 1e-9);
  EXPECT_TRUE(IsRight(shape, error.add_s_m));
  EXPECT_TRUE(IsStrictlyRight(shape, error));
}

TEST(ErrorOf, MeasuresAShift) {
  const MeasuredShape shape = Measure(Part("handle"));
  const PoseError error = ErrorOf(shape, At(0, 0), At(0.02, 0));
  EXPECT_NEAR(error.translation_m, 0.02, 1e-9);
  EXPECT_NEAR(error.hausdorff_m, 0.02, 0.001);
  EXPECT_FALSE(IsStrictlyRight(shape, error));
}

TEST(ErrorOf, IgnoresASymmetricTurn) {
  const MeasuredShape flange = Measure(Part("flange"));
  const PoseError quarter = ErrorOf(flange, At(0, 10), At(0, 100));
  EXPECT_LT(quarter.rotation_rad, 1e-6);
  EXPECT_LT(quarter.hausdorff_m, 0.003);
  const PoseError off = ErrorOf(flange, At(0, 10), At(0, 105));
  EXPECT_NEAR(off.rotation_rad * 180 / kPi, 5, 1e-6);
}

// ADD-S accepts it: the mean over the surface is small, but one end is far off.
TEST(IsStrictlyRight, ChecksEveryPoint) {
  const MeasuredShape shape = Measure(Part("stepped-block"));
  const PoseError turned = ErrorOf(shape, At(0, 0), At(0, 180));
  EXPECT_GT(turned.hausdorff_m, 0.008);
  EXPECT_FALSE(IsStrictlyRight(shape, turned));
}

Pose Turned(const Eigen::Vector3d& axis, double angle) {
  return Pose(Eigen::AngleAxisd(angle, axis.normalized()));
}

// A box of 60 x 40 x 20 mm, centred on the z axis.
MeasuredShape Box() { return Measure(BoxSolid({-0.03F, -0.02F, 0}, {0.03F, 0.02F, 0.02F})); }

TEST(RotationError, IsTheAngleBetweenTheRotations) {
  const Pose truth = Turned({1, 2, 3}, 0.4);
  EXPECT_NEAR(RotationError(truth, truth, 1), 0, 1e-7);
  EXPECT_NEAR(RotationError(truth, truth * Turned({0, 1, 0}, 0.3), 1), 0.3, 1e-9);
  EXPECT_NEAR(RotationError(truth, truth * Turned({0, 0, 1}, kPi), 1), kPi, 1e-6);
}

TEST(RotationError, IsTakenModuloTheSymmetry) {
  const Pose truth = Turned({1, 2, 3}, 0.4);
  const auto turned = [&](double angle) { return truth * Turned({0, 0, 1}, angle); };
  EXPECT_NEAR(RotationError(truth, turned(kPi), 2), 0, 1e-6);
  EXPECT_NEAR(RotationError(truth, turned(kPi + 0.1), 2), 0.1, 1e-9);
  EXPECT_NEAR(RotationError(truth, turned(2 * kPi / 3), 3), 0, 1e-6);
  EXPECT_NEAR(RotationError(truth, turned(kPi), 4), 0, 1e-6);
  EXPECT_NEAR(RotationError(truth, turned(kPi / 2), 2), kPi / 2, 1e-9);
}

TEST(RotationError, OnlyTheAxisCountsForAnyTurn) {
  const Pose truth = Turned({1, 2, 3}, 0.4);
  EXPECT_NEAR(RotationError(truth, truth * Turned({0, 0, 1}, 1.234), 0), 0, 1e-7);
  EXPECT_NEAR(RotationError(truth, truth * Turned({1, 0, 0}, 0.2), 0), 0.2, 1e-9);
}

TEST(AddS, IsZeroForTheTruthAndForASymmetricTurn) {
  const MeasuredShape shape = Box();
  const Pose truth = Turned({0, 0, 1}, 0.7);
  EXPECT_LT(AddS(shape, truth, truth), 0.0005);
  EXPECT_LT(AddS(shape, truth, truth * Turned({0, 0, 1}, kPi)), 0.0005);
  EXPECT_GT(AddS(shape, truth, truth * Turned({0, 0, 1}, kPi / 2)), 0.002);
}

TEST(AddS, IsTheShiftOfAFarAwayModel) {
  const MeasuredShape shape = Box();
  const Pose truth = Pose::Identity();
  Pose far = truth;
  far.translation().z() = 1;
  EXPECT_NEAR(AddS(shape, truth, far), 1 - 0.01, 0.005);  // to its nearest face
}

}  // namespace
}  // namespace graspdb::rendering
