#include "rendering/capture_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "rendering/camera/depth_camera.h"
#include "rendering/sample_parts.h"

namespace graspdb::rendering {
namespace {

const std::vector<Workpiece>& Parts() {
  static const std::vector<Workpiece> parts = SampleParts();
  return parts;
}

double TurnDeg(const recognition::Pose& pose) {
  const double deg = std::atan2(pose(1, 0), pose(0, 0)) * 180 / std::numbers::pi;
  return deg < -1e-9 ? deg + 360 : deg;
}

TEST(CapturePlan, TurntableTurnsTheObjectBeforeAFixedCamera) {
  TurntableOptions options;
  options.azimuth_step_deg = 90;
  options.stand.look_down_deg = {30, 50};
  options.stand.distances_m = {0.7, 0.9};
  const auto plan = PlanTurntable({Parts()[0], Parts()[1]}, options);
  ASSERT_TRUE(plan.ok()) << plan.status();
  ASSERT_EQ(plan->size(), 2U * 2 * 2 * 4);
  std::set<std::string> paths;
  std::set<std::uint64_t> seeds;
  for (std::size_t i = 0; i < plan->size(); ++i) {
    const PlannedCapture& capture = (*plan)[i];
    paths.insert(capture.path);
    seeds.insert(capture.seed);
    EXPECT_EQ(capture.split, v1::Capture::TEACH);
    ASSERT_EQ(capture.placements.size(), 1U);
    EXPECT_EQ(capture.placements[0].part, i / 16);
    EXPECT_NEAR(TurnDeg(capture.placements[0].world_object), 90.0 * static_cast<double>(i % 4),
                1e-9);
    const double look_down_deg = (i / 8) % 2 == 0 ? 30 : 50;
    const double distance_m = (i / 4) % 2 == 0 ? 0.7 : 0.9;
    EXPECT_TRUE(capture.world_sensor.isApprox(
        LookAt(Eigen::Vector3d::Zero(), distance_m, look_down_deg, -90), 1e-12));
  }
  EXPECT_EQ(paths.size(), plan->size());
  EXPECT_EQ(seeds.size(), plan->size());
}

TEST(CapturePlan, CoversAWholeTurnWithAnyStep) {
  TurntableOptions options;
  options.azimuth_step_deg = 100;
  EXPECT_EQ(PlanTurntable({Parts()[0]}, options)->size(), 4U);
  options.azimuth_step_deg = 360.0 / 7;
  EXPECT_EQ(PlanTurntable({Parts()[0]}, options)->size(), 7U);
}

TEST(CapturePlan, RandomScenesAreUniformInPositionTurnAndPart) {
  RandomSceneOptions options;
  options.count = 1300;
  const auto plan = PlanRandomScenes(Parts(), options);
  ASSERT_TRUE(plan.ok()) << plan.status();
  std::vector<int> of_part(Parts().size());
  std::vector<int> of_quarter(4);
  Eigen::Vector2d largest = Eigen::Vector2d::Zero();
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const PlannedCapture& capture : *plan) {
    EXPECT_EQ(capture.split, v1::Capture::QUERY);
    const Placement& named = capture.placements.front();
    ++of_part[named.part];
    ++of_quarter[static_cast<std::size_t>(TurnDeg(named.world_object) / 90)];
    const Eigen::Vector2d at = named.world_object.translation().head<2>();
    largest = largest.cwiseMax(at.cwiseAbs());
    sum += at;
    EXPECT_EQ(named.world_object.translation().z(), 0);
    EXPECT_NEAR(named.world_object.linear()(2, 2), 1, 1e-12);
    EXPECT_TRUE(capture.world_sensor.isApprox(LookAt(Eigen::Vector3d::Zero(), 0.8, 40, -90)));
  }
  EXPECT_THAT(of_part, testing::Each(100));
  EXPECT_THAT(of_quarter, testing::Each(testing::AllOf(testing::Gt(270), testing::Lt(380))));
  EXPECT_LE(largest.maxCoeff(), 0.10);
  EXPECT_GT(largest.minCoeff(), 0.099);
  EXPECT_LT(sum.norm() / 1300, 0.006);
}

TEST(CapturePlan, FirstScenesDoNotDependOnTheCount) {
  RandomSceneOptions options;
  options.count = 5;
  options.objects_per_scene = 3;
  const auto few = PlanRandomScenes(Parts(), options);
  options.count = 50;
  const auto many = PlanRandomScenes(Parts(), options);
  options.seed = 2;
  const auto other = PlanRandomScenes(Parts(), options);
  for (std::size_t i = 0; i < few->size(); ++i) {
    EXPECT_EQ((*few)[i].path, (*many)[i].path);
    EXPECT_EQ((*few)[i].seed, (*many)[i].seed);
    EXPECT_NE((*few)[i].seed, (*other)[i].seed);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& pose = (*few)[i].placements[k].world_object.matrix();
      EXPECT_EQ(pose, (*many)[i].placements[k].world_object.matrix());
      EXPECT_NE(pose, (*other)[i].placements[k].world_object.matrix());
    }
  }
}

TEST(CapturePlan, KeepsObjectsApart) {
  RandomSceneOptions options;
  options.count = 100;
  options.objects_per_scene = 4;
  const auto plan = PlanRandomScenes(Parts(), options);
  ASSERT_TRUE(plan.ok()) << plan.status();
  const auto world = [](const Placement& p) {
    std::vector<Eigen::Vector2f> points;
    for (const Eigen::Vector3f& v : Transformed(Parts()[p.part].mesh, p.world_object).vertices) {
      points.emplace_back(v.head<2>());
    }
    return points;
  };
  for (const PlannedCapture& capture : *plan) {
    ASSERT_EQ(capture.placements.size(), 4U);
    for (std::size_t a = 0; a < 4; ++a) {
      for (const Eigen::Vector2f& p : world(capture.placements[a])) {
        EXPECT_LE(p.cwiseAbs().maxCoeff(), kRegionHalfWidthM);
        for (std::size_t b = 0; b < a; ++b) {
          for (const Eigen::Vector2f& q : world(capture.placements[b])) {
            ASSERT_GT((p - q).norm(), 0.0099F) << capture.path;
          }
        }
      }
    }
  }
}

TEST(CapturePlan, RejectsInvalidPlans) {
  const auto code = [](const auto& plan) { return plan.status().code(); };
  constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;
  EXPECT_EQ(code(PlanTurntable({}, {})), kInvalid);
  EXPECT_EQ(code(PlanTurntable({Parts()[0], Parts()[0]}, {})), kInvalid);
  for (const double step : {0.0, -15.0, 400.0, std::nan("")}) {
    TurntableOptions options;
    options.azimuth_step_deg = step;
    EXPECT_EQ(code(PlanTurntable(Parts(), options)), kInvalid) << step;
  }
  TurntableOptions nowhere;
  nowhere.stand.distances_m = {};
  EXPECT_EQ(code(PlanTurntable(Parts(), nowhere)), kInvalid);
  nowhere.stand.distances_m = {-1};
  EXPECT_EQ(code(PlanTurntable(Parts(), nowhere)), kInvalid);
  EXPECT_EQ(code(PlanRandomScenes(Parts(), {})), kInvalid);
  RandomSceneOptions crowd;
  crowd.count = 1;
  crowd.objects_per_scene = 60;
  EXPECT_EQ(code(PlanRandomScenes(Parts(), crowd)), absl::StatusCode::kFailedPrecondition);
}

}  // namespace
}  // namespace graspdb::rendering
