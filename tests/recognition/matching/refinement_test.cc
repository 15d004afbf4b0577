#include "recognition/matching/refinement.h"

#include <gtest/gtest.h>

#include <optional>

#include "tests/recognition/scenes/seen_from_above.h"
#include "tests/recognition/scenes/synthetic_clouds.h"

namespace graspdb::recognition {
namespace {

using ::graspdb::testing::Moved;
using ::graspdb::testing::Random;
using ::graspdb::testing::RandomMotion;
using ::graspdb::testing::SeenFromAbove;
using ::graspdb::testing::WavySurface;

double Error(const SurfaceModel& model, const Pose& a, const Pose& b) {
  double largest = 0;
  for (const auto& p : model.fine.cloud.points) {
    largest = std::max(largest, (a * p.cast<double>() - b * p.cast<double>()).norm());
  }
  return largest;
}

// A wavy patch, 3 mm above where it was taught, seen from above.
class RefinementTest : public ::testing::Test {
 protected:
  RefinementTest() {
    truth_.translation() = Eigen::Vector3d(0.2, -0.1, 0.003);
    truth_.linear() = Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    seen_.emplace(Moved(truth_, WavySurface(random_, 2500)));
  }

  RefinementTarget Target(bool on_table) const { return seen_->Target(on_table); }

  Random random_{3};
  const SurfaceModel model_{WavySurface(random_, 6000), 1};
  Pose truth_ = Pose::Identity();
  std::optional<SeenFromAbove> seen_;
};

TEST_F(RefinementTest, ConvergesFromAnyDirection) {
  for (int i = 0; i < 20; ++i) {
    const Pose initial = RandomMotion(random_, truth_.translation(), 0.12, 0.01) * truth_;
    const Pose found = Refine(model_, Target(false), initial, {.iterations = 20}).world_object;
    EXPECT_LT(Error(model_, found, truth_), 0.0005) << i;
  }
}

TEST_F(RefinementTest, AFirmTableKeepsHeightAndTilt) {
  Pose initial = truth_;
  initial.translation() += Eigen::Vector3d(0.006, -0.004, 0.002);
  initial.linear() = initial.linear() * Eigen::AngleAxisd(0.06, Eigen::Vector3d::UnitZ());
  const Pose found =
      Refine(model_, Target(true), initial,
             {.iterations = 20, .height_deviation_m = 1e-6, .tilt_deviation_rad = 1e-6})
          .world_object;
  EXPECT_LT(std::abs(found.translation().z()), 1e-4);
  EXPECT_GT(found.linear()(2, 2), 1 - 1e-6);
}

// The calibration is off by a degree; the table shows how the object stands.
TEST_F(RefinementTest, AMeasuredTableReplacesTheCalibratedOne) {
  const Eigen::AngleAxisd off(0.0175, Eigen::Vector3d::UnitX());
  RefinementTarget target = Target(true);
  target.table = Plane{off * Eigen::Vector3d::UnitZ(), 0};
  const Pose found =
      Refine(model_, target, truth_,
             {.iterations = 20, .height_deviation_m = 1e-6, .tilt_deviation_rad = 1e-6})
          .world_object;
  EXPECT_LT((found.linear().col(2) - target.table->normal).norm(), 5e-4);
}

TEST_F(RefinementTest, AFlatPlateDoesNotSlide) {
  OrientedCloud plate;
  for (int row = 0; row < 40; ++row) {
    for (int column = 0; column < 60; ++column) {
      plate.points.emplace_back(0.002F * static_cast<float>(column),
                                0.002F * static_cast<float>(row), 0);
      plate.normals.emplace_back(0, 0, 1);
    }
  }
  const SurfaceModel model(plate, 1);
  const SeenFromAbove seen(plate);
  Pose initial = Pose::Identity();
  initial.translation() = Eigen::Vector3d(0.007, -0.006, 0.002);
  const Pose found = Refine(model, seen.Target(false), initial, {.iterations = 30}).world_object;
  EXPECT_LT(found.translation().head<2>().norm(), 0.0035);  // the points' distance and a half
  EXPECT_LT(std::abs(found.translation().z()), 1e-4);
}

TEST_F(RefinementTest, ARefinementThatStillMovesHasNotConverged) {
  Pose initial = truth_;
  initial.translation() += Eigen::Vector3d(0.006, -0.004, 0.002);
  const Refinement first = Refine(model_, Target(false), initial, {.iterations = 1});
  EXPECT_FALSE(first.converged);
  EXPECT_EQ(first.iterations, 1);
  EXPECT_TRUE(Refine(model_, Target(false), initial, {.iterations = 20}).converged);
  initial.translation().x() += 1;
  EXPECT_FALSE(Refine(model_, Target(false), initial, {}).converged) << "nothing is near";
}

TEST_F(RefinementTest, WithoutCorrespondencesTheInitialPoseStays) {
  Pose initial = truth_;
  initial.translation().x() += 1;
  EXPECT_TRUE(Refine(model_, Target(true), initial, {}).world_object.isApprox(initial, 0));
}

}  // namespace
}  // namespace graspdb::recognition
