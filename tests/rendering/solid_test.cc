#include "rendering/meshes/solid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "tests/rendering/mesh_measure.h"

namespace graspdb::rendering {
namespace {

// An L of area 3.
const Polygon ell = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};

TEST(Solid, ShellsAreClosedAndHaveTheirVolume) {
  EXPECT_TRUE(IsClosed(BoxSolid({0, 0, 0}, {1, 2, 3})));
  EXPECT_NEAR(VolumeOf(BoxSolid({0, 0, 0}, {1, 2, 3})), 6, 1e-5);
  EXPECT_TRUE(IsClosed(ExtrudeUp(ell, 1, 5)));
  EXPECT_NEAR(VolumeOf(ExtrudeUp(ell, 1, 5)), 12, 1e-5);
  const TriangleMesh cylinder = CylinderSolid({3, 3}, 2, 0, 1);
  EXPECT_TRUE(IsClosed(cylinder));
  EXPECT_NEAR(VolumeOf(cylinder), 4 * std::numbers::pi, 0.03);
  const TriangleMesh ring =
      RingSolid(RegularPolygon({0, 0}, 2, 64, 0), RegularPolygon({0, 0}, 1, 64, 0), 1);
  EXPECT_TRUE(IsClosed(ring));
  EXPECT_NEAR(VolumeOf(ring), 3 * std::numbers::pi, 0.03);
}

TEST(Solid, ProfilesAlongXAndYKeepTheirAxes) {
  const TriangleMesh along_y = ExtrudeAlongY(ell, 4, 7);
  EXPECT_TRUE(IsClosed(along_y));
  EXPECT_NEAR(VolumeOf(along_y), 9, 1e-5);
  EXPECT_EQ(BoundsOf(along_y).min, Eigen::Vector3d(0, 4, 0));
  EXPECT_EQ(BoundsOf(along_y).max, Eigen::Vector3d(2, 7, 2));
  const Polygon flat = {{0, 0}, {5, 0}, {5, 1}, {0, 1}};  // 5 wide, 1 high
  EXPECT_EQ(BoundsOf(ExtrudeAlongY(flat, 0, 2)).max, Eigen::Vector3d(5, 2, 1));
  EXPECT_EQ(BoundsOf(ExtrudeAlongX(flat, 0, 2)).max, Eigen::Vector3d(2, 5, 1));
  EXPECT_NEAR(VolumeOf(ExtrudeAlongX(flat, 0, 2)), 10, 1e-5);
}

TEST(Solid, MirrorImageKeepsOutwardNormals) {
  const TriangleMesh solid = ExtrudeUp(ell, 0, 1);
  const TriangleMesh mirrored = MirroredX(solid);
  EXPECT_NEAR(VolumeOf(mirrored), VolumeOf(solid), 1e-6);
  EXPECT_EQ(BoundsOf(mirrored).min, Eigen::Vector3d(-2, 0, 0));
}

TEST(Solid, UnionKeepsEveryShell) {
  const TriangleMesh two = Union({BoxSolid({0, 0, 0}, {1, 1, 1}), BoxSolid({5, 0, 0}, {6, 1, 2})});
  EXPECT_TRUE(IsClosed(two));
  EXPECT_NEAR(VolumeOf(two), 3, 1e-5);
  EXPECT_TRUE(CheckMesh(two).ok());
}

}  // namespace
}  // namespace graspdb::rendering
