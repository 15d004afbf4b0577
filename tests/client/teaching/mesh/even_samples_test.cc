#include <gtest/gtest.h>

#include <cmath>

#include "client/teaching/mesh/top_grasps.h"
#include "rendering/meshes/solid.h"

namespace graspdb::client {
namespace {

constexpr int kCount = 2000;

TEST(EvenSamples, AreAboutAsManyAsWanted) {
  const auto samples = SampleEvenly(rendering::BoxSolid({0, 0, 0}, {0.1F, 0.2F, 0.3F}), kCount);
  EXPECT_NEAR(static_cast<double>(samples.areas.size()), kCount, 0.1 * kCount);
  EXPECT_EQ(samples.cloud.points.size(), samples.areas.size());
}

// Ribbons of nearly no area along a line of the grid.
TEST(EvenSamples, ThinTrianglesDoNotMultiplyThem) {
  constexpr int kRibbons = 1000;
  constexpr double kHalfWidth = 1e-7;
  constexpr double kArea = 0.06 + kRibbons * 0.1 * kHalfWidth;
  const double line = (1 - 0.381966) * std::sqrt(kArea / kCount);
  const auto low = static_cast<float>(line - kHalfWidth);
  const auto high = static_cast<float>(line + kHalfWidth);
  rendering::TriangleMesh mesh = rendering::BoxSolid({0, 0, 0}, {0.1F, 0.1F, 0.1F});
  const auto first = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), {{0, low, 0}, {0.1F, low, 0}, {0, high, 0}});
  for (int i = 0; i < kRibbons; ++i) mesh.triangles.push_back({first, first + 1, first + 2});
  const auto samples = SampleEvenly(mesh, kCount);
  EXPECT_EQ(samples.areas.size(), 2U * kCount);  // of which the ribbons would have more
}

}  // namespace
}  // namespace graspdb::client
