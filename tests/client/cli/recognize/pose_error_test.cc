#include "client/cli/recognize/pose_error.h"

#include <gtest/gtest.h>

#include <numbers>

#include "rendering/mesh.h"
#include "rendering/solid.h"

namespace graspdb::client {
namespace {

using recognition::Pose;

constexpr double kPi = std::numbers::pi;

Pose Turned(const Eigen::Vector3d& axis, double angle) {
  return Pose(Eigen::AngleAxisd(angle, axis.normalized()));
}

// A box of 60 x 40 x 20 mm, centred on the z axis.
ObjectModel BoxModel() {
  const TriangleMesh mesh = BoxSolid({-0.03F, -0.02F, 0}, {0.03F, 0.02F, 0.02F});
  return {SampleSurface(mesh, 1000, 1), recognition::PointSearch(SampleSurface(mesh, 50000, 2)),
          DiameterOf(mesh)};
}

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
  const ObjectModel model = BoxModel();
  const Pose truth = Turned({0, 0, 1}, 0.7);
  EXPECT_LT(AddS(model, truth, truth), 0.0005);
  EXPECT_LT(AddS(model, truth, truth * Turned({0, 0, 1}, kPi)), 0.0005);
  EXPECT_GT(AddS(model, truth, truth * Turned({0, 0, 1}, kPi / 2)), 0.002);
}

TEST(AddS, IsTheShiftOfAFarAwayModel) {
  const ObjectModel model = BoxModel();
  const Pose truth = Pose::Identity();
  Pose far = truth;
  far.translation().z() = 1;
  EXPECT_NEAR(AddS(model, truth, far), 1 - 0.01, 0.005);  // to its nearest face
}

}  // namespace
}  // namespace graspdb::client
