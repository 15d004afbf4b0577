#include "lab/experiment/trials/close_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "rendering/sample_parts.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::lab {
namespace {

using testing::IsOk;

// Smallest distance over the table between points of two workpieces, m.
double Gap(const std::vector<rendering::Workpiece>& parts, const rendering::Placement& a,
           const rendering::Placement& b) {
  const auto points = [&](const rendering::Placement& p) {
    recognition::Points out = rendering::SampleSurface(parts[p.part].mesh, 3000, /*seed=*/7);
    for (Eigen::Vector3f& point : out) point = p.world_object.cast<float>() * point;
    return out;
  };
  float gap = 1e9F;
  const recognition::Points of_b = points(b);
  for (const Eigen::Vector3f& p : points(a)) {
    for (const Eigen::Vector3f& q : of_b) gap = std::min(gap, (p - q).head<2>().norm());
  }
  return static_cast<double>(gap);
}

TEST(PlanCloseScenes, KeepsTheRequestedGap) {
  const std::vector<rendering::Workpiece> parts = rendering::SampleParts();
  const auto plan = PlanCloseScenes(parts, {.count = 5, .gap_m = 0.03, .seed = 3});
  ASSERT_THAT(plan, IsOk());
  ASSERT_EQ(plan->size(), 5U);
  for (const rendering::PlannedCapture& scene : *plan) {
    ASSERT_EQ(scene.placements.size(), 3U);
    std::set<std::size_t> different;
    for (const rendering::Placement& a : scene.placements) {
      different.insert(a.part);
      double nearest = 1;
      for (const rendering::Placement& b : scene.placements) {
        if (a.part != b.part) nearest = std::min(nearest, Gap(parts, a, b));
      }
      EXPECT_NEAR(nearest, 0.03, 0.004);  // between random points of the surfaces
      const Eigen::Vector3d at = a.world_object.translation();
      EXPECT_LT(at.head<2>().cwiseAbs().maxCoeff(), rendering::kRegionHalfWidthM);
    }
    EXPECT_EQ(different.size(), 3U);
  }
}

TEST(PlanCloseScenes, FailsWithTooManyObjects) {
  EXPECT_THAT(PlanCloseScenes(rendering::SampleParts(),
                              {.count = 1, .objects_per_scene = 13, .gap_m = 0.2}),
              testing::StatusIs(absl::StatusCode::kFailedPrecondition));
}

}  // namespace
}  // namespace graspdb::lab
