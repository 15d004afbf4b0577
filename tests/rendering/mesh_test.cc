#include "rendering/meshes/mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "rendering/meshes/solid.h"

namespace graspdb::rendering {
namespace {

TEST(Mesh, BoundsDiameterAndCentreOfABox) {
  const TriangleMesh box = BoxSolid({1, 2, 3}, {3, 5, 9});
  EXPECT_EQ(BoundsOf(box).min, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(BoundsOf(box).max, Eigen::Vector3d(3, 5, 9));
  EXPECT_NEAR(DiameterOf(box), 7, 1e-6);
  EXPECT_TRUE(CenterOfMass(box)->isApprox(Eigen::Vector3d(2, 3.5, 6), 1e-6));
}

TEST(Mesh, AreaOfABoxAndOfNoTriangles) {
  EXPECT_NEAR(AreaOf(BoxSolid({0, 0, 0}, {0.1F, 0.2F, 0.3F})), 0.22, 1e-6);
  EXPECT_EQ(AreaOf({}), 0);
}

TEST(Mesh, DiameterOfManyVerticesIsAlmostExact) {
  TriangleMesh cigar;
  for (int i = 0; i < 300; ++i) {
    const auto z = static_cast<float>(i) / 299 * 2 - 1;
    const float r = 0.3F * std::sqrt(1 - z * z);
    for (const Eigen::Vector2f& p : RegularPolygon({0, 0}, r, 20, 0)) {
      cigar.vertices.emplace_back(p.x() + z, p.y() + z, 0.5F * z);
    }
  }
  float squared = 0;
  for (const Eigen::Vector3f& a : cigar.vertices) {
    for (const Eigen::Vector3f& b : cigar.vertices) {
      squared = std::max(squared, (a - b).squaredNorm());
    }
  }
  const double exact = std::sqrt(static_cast<double>(squared));
  ASSERT_GT(cigar.vertices.size(), 4096U);
  EXPECT_LE(DiameterOf(cigar), exact * 1.000001);
  EXPECT_GE(DiameterOf(cigar), exact * 0.998);
}

TEST(Mesh, SamplesLieOnTheFacesInProportionToTheirArea) {
  const TriangleMesh box = BoxSolid({0, 0, 0}, {4, 2, 1});
  const recognition::Points points = SampleSurface(box, 20000, 3);
  ASSERT_EQ(points.size(), 20000U);
  int top = 0;
  Eigen::Vector2d on_top = Eigen::Vector2d::Zero();
  for (const Eigen::Vector3f& p : points) {
    const Eigen::Array3f from_face = p.array().min(Eigen::Array3f(4, 2, 1) - p.array());
    EXPECT_NEAR(from_face.minCoeff(), 0, 1e-5);
    if (p.z() < 1 - 1e-5F) continue;
    ++top;
    on_top += p.head<2>().cast<double>();
  }
  EXPECT_NEAR(top / 20000.0, 8.0 / 28, 0.015);
  EXPECT_NEAR(on_top.x() / top, 2, 0.05);
  EXPECT_NEAR(on_top.y() / top, 1, 0.025);
  EXPECT_EQ(SampleSurface(box, 50, 3), recognition::Points(points.begin(), points.begin() + 50));
  EXPECT_NE(SampleSurface(box, 50, 4), recognition::Points(points.begin(), points.begin() + 50));
}

TEST(Mesh, RejectsCentreOfMassOfAnOpenSheetAndSamplesOfNoTriangles) {
  TriangleMesh sheet;
  sheet.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  sheet.triangles = {{0, 1, 2}};
  EXPECT_EQ(CenterOfMass(sheet).status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_TRUE(SampleSurface(TriangleMesh{}, 10, 1).empty());
  EXPECT_EQ(DiameterOf(TriangleMesh{}), 0);
}

TEST(Mesh, RejectsBrokenMeshes) {
  TriangleMesh mesh = BoxSolid({0, 0, 0}, {1, 1, 1});
  EXPECT_TRUE(CheckMesh(mesh).ok());
  mesh.triangles[3][1] = 8;
  EXPECT_EQ(CheckMesh(mesh).code(), absl::StatusCode::kInvalidArgument);
  mesh.triangles[3][1] = -1;
  EXPECT_EQ(CheckMesh(mesh).code(), absl::StatusCode::kInvalidArgument);
  mesh = BoxSolid({0, 0, 0}, {1, 1, 1});
  mesh.vertices[2].y() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(CheckMesh(mesh).code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(CheckMesh(TriangleMesh{}).code(), absl::StatusCode::kInvalidArgument);
}

TEST(Mesh, TransformedRotatesBeforeItTranslates) {
  recognition::Pose pose(Eigen::Translation3d(0, 0, 5));
  pose.rotate(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ()));
  const TriangleMesh moved = Transformed(BoxSolid({0, 0, 0}, {2, 1, 1}), pose);
  EXPECT_TRUE(BoundsOf(moved).min.isApprox(Eigen::Vector3d(-1, 0, 5), 1e-6));
  EXPECT_TRUE(BoundsOf(moved).max.isApprox(Eigen::Vector3d(0, 2, 6), 1e-6));
}

}  // namespace
}  // namespace graspdb::rendering
