#include "recognition/rough_pose.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace graspdb::recognition {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

// Looks from the side of x < 0 down at the origin.
Pose WorldSensor() {
  const Vector3d eye(-0.6, 0, 0.6);
  const Vector3d z = -eye.normalized();
  const Vector3d x = -Vector3d::UnitZ().cross(z).normalized();
  Pose out = Pose::Identity();
  out.linear() << x, z.cross(x), z;
  out.translation() = eye;
  return out;
}

// A plate of 20 x 10 cm, 5 mm thick, and a leg of 8 cm that stands up at its far end: what the
// camera sees of it.
OrientedCloud Plate() {
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

// The points of `plate` higher than `least_m` where it stands at `world_object`, as a segment.
SeenSegment Seen(const OrientedCloud& plate, const Pose& world_object, float least_m) {
  Points points;
  for (const Vector3f& p : plate.points) {
    if (p.z() > least_m) points.emplace_back(world_object.cast<float>() * p);
  }
  SeenSegment out{.world_sensor = WorldSensor()};
  for (const Vector3f& p : points) out.centroid += p.cast<double>();
  out.centroid /= static_cast<double>(points.size());
  out.extent = ExtentOf(points, out.world_sensor.inverse().cast<float>());
  return out;
}

// How far from its place the plate is at the best of the first `count` rough poses, m.
double Off(const SeenSegment& segment, const SurfaceModel& model, const Pose& world_object,
           std::size_t count) {
  TaughtView view;
  view.world_sensor = WorldSensor();
  double best = 1;
  for (const Pose& rough : RoughPoses(view, model, segment, {})) {
    if (count-- == 0) break;
    best = std::min(best, (rough.translation() - world_object.translation()).norm());
  }
  return best;
}

TEST(RoughPoses, AThingThatIsSeenWholeHasOnePlace) {
  const SeenSegment whole = Seen(Plate(), Displaced(), 0);
  EXPECT_LT(Off(whole, SurfaceModel(Plate(), 24), Displaced(), 1), 0.015);
}

TEST(RoughPoses, WhatStandsUpFromAPlateThatWasTakenForTableSaysWhereThePlateIs) {
  const SurfaceModel model(Plate(), 24);
  const SeenSegment leg = Seen(Plate(), Displaced(), 0.006F);
  EXPECT_GT(Off(leg, model, Displaced(), 1), 0.04);
  EXPECT_LT(Off(leg, model, Displaced(), 2), 0.015);
}

}  // namespace
}  // namespace graspdb::recognition
