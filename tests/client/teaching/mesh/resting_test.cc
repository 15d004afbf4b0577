#include "client/teaching/mesh/resting.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <set>

#include "rendering/meshes/solid.h"
#include "tests/client/teaching/mesh/standing.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using ::graspdb::testing::IsOk;
using ::graspdb::testing::StatusIs;

struct Dropped {
  ConvexHull hull;
  MassCenter mass;
  std::vector<RestingFacet> facets;
};

Dropped Drop(const rendering::TriangleMesh& mesh, double roll_lift_m = 1e-5) {
  Dropped out;
  auto hull = HullOf(mesh.vertices);
  EXPECT_THAT(hull, IsOk());
  if (!hull.ok()) return out;
  out.hull = *std::move(hull);
  out.mass = CenterOfMass(mesh, out.hull);
  auto facets = RestingFacets(out.hull, out.mass.center, roll_lift_m);
  EXPECT_THAT(facets, IsOk());
  if (facets.ok()) out.facets = *std::move(facets);
  return out;
}

double Sum(const std::vector<RestingFacet>& facets) {
  return std::accumulate(facets.begin(), facets.end(), 0.0,
                         [](double sum, const RestingFacet& f) { return sum + f.probability; });
}

double ProbabilityOf(const std::vector<RestingFacet>& facets, const Eigen::Vector3d& down) {
  double sum = 0;
  for (const RestingFacet& f : facets) sum += f.down.dot(down) > 0.9999 ? f.probability : 0;
  return sum;
}

// A tower whose top is moved to the side by `lean_m`.
rendering::TriangleMesh LeaningTower(float lean_m) {
  return rendering::ExtrudeAlongX({{0, 0}, {0.02F, 0}, {0.02F + lean_m, 0.1F}, {lean_m, 0.1F}}, 0,
                                  0.02F);
}

TEST(ConvexHull, ABoxHasSixFacetsOfFourSides) {
  const auto hull = HullOf(rendering::BoxSolid({0, 0, 0}, {0.1F, 0.2F, 0.3F}).vertices);
  ASSERT_THAT(hull, IsOk());
  EXPECT_EQ(hull->points.size(), 8U);
  ASSERT_EQ(hull->facets.size(), 6U);
  for (const HullFacet& facet : hull->facets) EXPECT_EQ(facet.edges.size(), 4U);
  EXPECT_NEAR(MassOf(*hull).volume_m3, 0.006, 1e-8);
  EXPECT_TRUE(MassOf(*hull).center.isApprox(Eigen::Vector3d(0.05, 0.1, 0.15), 1e-6));
}

TEST(RestingFacets, AreAsLikelyAsTheSolidAnglesOfABoxFaces) {
  const double a = 0.04, b = 0.07, c = 0.1;
  const Dropped box = Drop(rendering::BoxSolid({0, 0, 0}, {0.04F, 0.07F, 0.1F}));
  ASSERT_EQ(box.facets.size(), 6U);
  const auto share = [](double width, double depth, double height) {
    const double diagonal = std::sqrt(width * width + depth * depth + height * height);
    return std::atan(width * depth / (height * diagonal)) / std::numbers::pi;
  };
  EXPECT_NEAR(ProbabilityOf(box.facets, {0, 0, -1}), share(a, b, c), 1e-6);
  EXPECT_NEAR(ProbabilityOf(box.facets, {0, 1, 0}), share(a, c, b), 1e-6);
  EXPECT_NEAR(ProbabilityOf(box.facets, {-1, 0, 0}), share(b, c, a), 1e-6);
  EXPECT_NEAR(Sum(box.facets), 1, 1e-9);
}

TEST(RestingFacets, ATowerThatLeansTooFarDoesNotStand) {
  const Eigen::Vector3d down = -Eigen::Vector3d::UnitZ();
  const Dropped upright = Drop(LeaningTower(0));
  EXPECT_GT(ProbabilityOf(upright.facets, down), 0.003);
  const Dropped leaning = Drop(LeaningTower(0.06F));
  EXPECT_EQ(ProbabilityOf(leaning.facets, down), 0);
  EXPECT_NEAR(Sum(leaning.facets), 1, 1e-9) << "drops on its foot roll on to another facet";
  // Its foot is under its lower side, to which it falls, and not under the upper one.
  const Eigen::Vector3d lower = Eigen::Vector3d(0, 0.1, -0.06).normalized();
  EXPECT_GT(ProbabilityOf(leaning.facets, lower), ProbabilityOf(leaning.facets, -lower));
}

TEST(RestingFacets, SidesOfARoundObjectAreOneBasin) {
  const Dropped can = Drop(rendering::CylinderSolid({0, 0}, 0.03F, 0, 0.1F), 5e-4);
  std::set<int> basins;
  for (const RestingFacet& f : can.facets) basins.insert(f.basin);
  EXPECT_EQ(basins.size(), 3U) << "two ends, and the side";
  const Dropped box = Drop(rendering::BoxSolid({0, 0, 0}, {0.04F, 0.04F, 0.04F}), 5e-4);
  basins.clear();
  for (const RestingFacet& f : box.facets) basins.insert(f.basin);
  EXPECT_EQ(basins.size(), 6U);
}

TEST(TipAngle, IsWhereTheCentreOfMassPassesOverTheEdge) {
  const Dropped box = Drop(rendering::BoxSolid({0, 0, 0}, {0.04F, 0.06F, 0.1F}));
  EXPECT_NEAR(TipAngle(box.hull, box.mass.center, {0, 0, -1}, 1e-5), std::atan(0.4), 1e-6);
  const Dropped leaning = Drop(LeaningTower(0.06F));
  EXPECT_LT(TipAngle(leaning.hull, leaning.mass.center, {0, 0, -1}, 1e-5), 0);
}

TEST(CenterOfMass, IsThatOfTheHullWhereTheSurfaceIsOpen) {
  rendering::TriangleMesh bracket = rendering::ExtrudeAlongY(
      {{0, 0}, {0.1F, 0}, {0.1F, 0.02F}, {0.02F, 0.02F}, {0.02F, 0.1F}, {0, 0.1F}}, 0, 0.03F);
  const Dropped closed = Drop(bracket);
  EXPECT_FALSE(closed.mass.of_hull);
  EXPECT_TRUE(closed.mass.center.isApprox(WeighedCenter(bracket), 1e-5));
  std::erase_if(bracket.triangles, [&](const auto& t) {  // without its lower face
    return std::ranges::all_of(
        t, [&](int i) { return bracket.vertices[static_cast<std::size_t>(i)].z() == 0; });
  });
  const Dropped open = Drop(bracket);
  EXPECT_TRUE(open.mass.of_hull);
  EXPECT_TRUE(open.mass.center.isApprox(MassOf(open.hull).center, 1e-9));
}

TEST(HullOf, RejectsPointsWithoutVolume) {
  EXPECT_THAT(HullOf({}), StatusIs(absl::StatusCode::kInvalidArgument));
  EXPECT_THAT(HullOf({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5F, 0.2F, 0}}),
              StatusIs(absl::StatusCode::kInvalidArgument));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(HullOf({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, nan}}),
              StatusIs(absl::StatusCode::kInvalidArgument));
}

}  // namespace
}  // namespace graspdb::client
