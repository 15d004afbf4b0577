#include "recognition/matching/rough_pose.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/recognition/scenes/table_scene.h"

namespace graspdb::recognition {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using ::testing::ElementsAre;
using ::testing::Gt;
using ::testing::Lt;

// How high above the table everything is removed with it, m.
constexpr double kTableReachM = 0.006;

Pose WorldSensor() { return graspdb::testing::LookAt({-0.6, 0, 0.6}, Vector3d::Zero()); }

// A plate of 20 x 10 cm, 5 mm thick, and a leg of 8 cm that stands up at its far end: the visible
// points.
OrientedCloud AnglePlate() {
  OrientedCloud out;
  for (int i = 0; i < 80; ++i) {
    for (int j = 0; j < 40; ++j) {
      const auto along = static_cast<float>(i) * 0.0025F;
      const auto across = static_cast<float>(j) * 0.0025F - 0.05F;
      out.points.emplace_back(along - 0.1F, across, 0.005F);
      out.normals.emplace_back(0.0F, 0.0F, 1.0F);
      if (along >= 0.075F) continue;
      out.points.emplace_back(0.1F, across, 0.005F + along);
      out.normals.emplace_back(-1.0F, 0.0F, 0.0F);
    }
  }
  return out;
}

// Where it stands in the tests, away from where it was taught.
Pose Displaced() {
  Pose out = Pose::Identity();
  out.translation() = Vector3d(0.05, 0, 0);
  return out;
}

// The segment after removing all points up to `table_reach_m`.
SeenSegment Seen(double table_reach_m) {
  Points points;
  for (const Vector3f& p : AnglePlate().points) {
    if (static_cast<double>(p.z()) > table_reach_m) {
      points.emplace_back(Displaced().cast<float>() * p);
    }
  }
  SeenSegment out{.world_sensor = WorldSensor(), .table_reach_m = table_reach_m};
  for (const Vector3f& p : points) out.centroid += p.cast<double>();
  out.centroid /= static_cast<double>(points.size());
  out.extent = ExtentOf(points, out.world_sensor.inverse().cast<float>());
  return out;
}

// How far from their place the plate is at its rough poses, m.
std::vector<double> Offs(const SeenSegment& segment, const DepthBuffer::Sides& hidden = {}) {
  TaughtView view;
  view.world_sensor = WorldSensor();
  std::vector<double> out;
  for (const Pose& rough :
       RoughPoses(view, SurfaceModel(AnglePlate(), 24), segment, hidden).poses) {
    out.push_back((rough.translation() - Displaced().translation()).norm());
  }
  return out;
}

TEST(RoughPoses, AFullyVisibleObjectIsPlacedExactly) {
  EXPECT_THAT(Offs(Seen(/*table_reach_m=*/0)), ElementsAre(Lt(0.015)));
}

TEST(RoughPoses, AnUprightLegLocatesAPlateRemovedWithTheTable) {
  EXPECT_THAT(Offs(Seen(kTableReachM)), ElementsAre(Gt(0.04), Lt(0.015)));
}

// The left half of the plate in the image, without a table.
TEST(RoughPoses, AnySideOfASegmentedScanMayBeHidden) {
  Points half;
  const Eigen::Isometry3f sensor_world = WorldSensor().inverse().cast<float>();
  for (const Vector3f& p : AnglePlate().points) {
    const Vector3f world = Displaced().cast<float>() * p;
    if ((sensor_world * world).x() < 0) half.push_back(world);
  }
  SeenSegment seen{.world_sensor = WorldSensor()};
  for (const Vector3f& p : half) seen.centroid += p.cast<double>();
  seen.centroid /= static_cast<double>(half.size());
  seen.extent = ExtentOf(half, sensor_world);
  const auto nearest = [&](const DepthBuffer::Sides& hidden) {
    const std::vector<double> offs = Offs(seen, hidden);
    return *std::ranges::min_element(offs);
  };
  EXPECT_GT(nearest({}), 0.02);
  EXPECT_LT(nearest({.left = true, .right = true, .top = true, .bottom = true}), 0.01);
}

TEST(RoughPoses, WithoutRemovedPointsTheWholeModelIsMatched) {
  SeenSegment leg = Seen(kTableReachM);
  leg.table_reach_m = 0;
  EXPECT_THAT(Offs(leg), ElementsAre(Gt(0.04)));
}

}  // namespace
}  // namespace graspdb::recognition
