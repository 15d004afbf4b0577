#include "rendering/meshes/outward_faces.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "rendering/meshes/solid.h"
#include "tests/rendering/mesh_measure.h"

namespace graspdb::rendering {
namespace {

void Flip(TriangleMesh& mesh, std::size_t triangle) {
  std::swap(mesh.triangles[triangle][1], mesh.triangles[triangle][2]);
}

TriangleMesh Flipped(TriangleMesh mesh) {
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) Flip(mesh, i);
  return mesh;
}

TriangleMesh Joined(TriangleMesh mesh, const TriangleMesh& other) {
  const auto first = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& [a, b, c] : other.triangles) {
    mesh.triangles.push_back({first + a, first + b, first + c});
  }
  return mesh;
}

TriangleMesh Box(float half) { return BoxSolid({-half, -half, -half}, {half, half, half}); }

TEST(OutwardFaces, AnyFacesOfAClosedSurfaceMayBeTurned) {
  const TriangleMesh good = BoxSolid({0, 0, 0}, {0.1F, 0.2F, 0.3F});
  for (unsigned turned = 0; turned < 1U << good.triangles.size(); turned += 37) {
    TriangleMesh mesh = good;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      if ((turned >> i & 1U) != 0) Flip(mesh, i);
    }
    TurnOutwards(mesh);
    ASSERT_TRUE(IsClosed(mesh)) << turned;
    ASSERT_NEAR(VolumeOf(mesh), 0.006, 1e-8) << turned;
    ASSERT_EQ(OpposedShare(mesh), 0) << turned;
  }
}

// 8 without 1: also where the whole part, or any face, is turned.
TEST(OutwardFaces, ACavityStaysOne) {
  for (const bool is_mirrored : {false, true}) {
    const TriangleMesh hollow = Joined(Box(1), Flipped(Box(0.5F)));
    TriangleMesh mesh = is_mirrored ? Flipped(hollow) : hollow;
    TurnOutwards(mesh);
    EXPECT_NEAR(VolumeOf(mesh), 7, 1e-6);
    for (std::size_t i = 0; i < mesh.triangles.size(); i += 2) Flip(mesh, i);
    TurnOutwards(mesh);
    EXPECT_NEAR(VolumeOf(mesh), 7, 1e-6);
  }
}

// Such as a bolt in its plate: a union, whose shells all turn outwards.
TEST(OutwardFaces, AShellThatTurnsAsTheOneAroundItIsNoCavity) {
  for (const bool is_mirrored : {false, true}) {
    const TriangleMesh both = Joined(Box(1), Box(0.5F));
    TriangleMesh mesh = is_mirrored ? Flipped(both) : both;
    TurnOutwards(mesh);
    EXPECT_NEAR(VolumeOf(mesh), 9, 1e-6);
  }
}

TEST(OutwardFaces, ShellsBesideEachOtherAreTurnedOneByOne) {
  TriangleMesh other = Flipped(Box(1));
  for (Eigen::Vector3f& v : other.vertices) v.x() += 5;
  TriangleMesh mesh = Joined(Box(1), other);
  TurnOutwards(mesh);
  EXPECT_NEAR(VolumeOf(mesh), 16, 1e-6);
}

TEST(OutwardFaces, MoreShellsThanAreComparedKeepTheirCavities) {
  TriangleMesh mesh;
  for (int i = 0; i < 50; ++i) {
    TriangleMesh hollow = Flipped(Joined(Box(1), Flipped(Box(0.5F))));
    for (Eigen::Vector3f& v : hollow.vertices) v.x() += 5 * static_cast<float>(i);
    mesh = Joined(std::move(mesh), hollow);
  }
  TurnOutwards(mesh);
  EXPECT_NEAR(VolumeOf(mesh), 50 * 7, 1e-3);
}

TEST(OutwardFaces, AFewTurnedFacesOfAnOpenSurfaceAreTurnedBack) {
  TriangleMesh open = BoxSolid({0, 0, 0}, {1, 1, 1});
  open.triangles.pop_back();
  TriangleMesh mesh = open;
  Flip(mesh, 3);
  TurnOutwards(mesh);
  EXPECT_EQ(OpposedShare(mesh), 0);
  EXPECT_NEAR(VolumeOf(mesh), VolumeOf(open), 1e-9);
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 2) Flip(mesh, i);
  const TriangleMesh mixed = mesh;
  TurnOutwards(mesh);
  EXPECT_TRUE(mesh.triangles == mixed.triangles);
  EXPECT_GT(OpposedShare(mesh), 0);
}

TEST(OutwardFaces, RepeatedTrianglesAreRemoved) {
  const TriangleMesh box = Box(1);
  TriangleMesh twice = box;
  twice.triangles.insert(twice.triangles.end(), box.triangles.begin(), box.triangles.end());
  TriangleMesh both_sides = box;
  for (const auto& [a, b, c] : box.triangles) both_sides.triangles.push_back({b, a, c});
  TriangleMesh one_again = box;
  const auto [a, b, c] = box.triangles[5];
  one_again.triangles.push_back({b, c, a});
  for (TriangleMesh mesh : {box, twice, both_sides, one_again}) {
    RemoveRepeated(mesh);
    EXPECT_TRUE(mesh.triangles == box.triangles);
  }
  TriangleMesh wall = box;  // of a few triangles both sides are there
  wall.triangles.push_back({b, a, c});
  const TriangleMesh before = wall;
  RemoveRepeated(wall);
  EXPECT_TRUE(wall.triangles == before.triangles);
}

TEST(OutwardFaces, ASurfaceWithOneSideStaysAsItIs) {
  TriangleMesh mesh;  // a strip with half a twist
  constexpr int kSteps = 12;
  for (int i = 0; i < kSteps; ++i) {
    const double turn = 2 * std::numbers::pi * i / kSteps;
    for (const double side : {-0.3, 0.3}) {
      const double r = 1 + side * std::cos(turn / 2);
      mesh.vertices.push_back(
          Eigen::Vector3d(r * std::cos(turn), r * std::sin(turn), side * std::sin(turn / 2))
              .cast<float>());
    }
  }
  for (int i = 0; i < kSteps; ++i) {
    const bool is_last = i + 1 == kSteps;
    const int next = is_last ? 1 : 2 * i + 2;
    const int beyond = is_last ? 0 : 2 * i + 3;
    mesh.triangles.push_back({2 * i, next, 2 * i + 1});
    mesh.triangles.push_back({2 * i + 1, next, beyond});
  }
  const TriangleMesh before = mesh;
  TurnOutwards(mesh);
  EXPECT_TRUE(mesh.triangles == before.triangles);
  EXPECT_GT(OpposedShare(mesh), 0);
}

}  // namespace
}  // namespace graspdb::rendering
