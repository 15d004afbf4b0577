#include "client/eval/resting_pose.h"

#include <gtest/gtest.h>

#include "client/simulation/solid.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using testing::IsOk;
using testing::StatusIs;

// Height of the mesh as it rests.
double HeightOf(const TriangleMesh& mesh, const RestingPose& rest) {
  const recognition::Box box = BoundsOf(Transformed(mesh, rest.table_mesh));
  EXPECT_NEAR(box.min.z(), 0, 1e-6);
  EXPECT_NEAR(box.min.x(), -box.max.x(), 1e-6);
  EXPECT_NEAR(box.min.y(), -box.max.y(), 1e-6);
  return box.max.z();
}

TEST(RestingPoses, ABlockRestsOnItsSixFacesAndMostOftenOnTheLargest) {
  const TriangleMesh block = BoxSolid({0, 0, 0}, {0.04F, 0.07F, 0.1F});
  const auto rests = RestingPoses(block, 0);
  ASSERT_THAT(rests, IsOk());
  ASSERT_EQ(rests->size(), 6U);
  double sum = 0;
  for (const RestingPose& rest : *rests) sum += rest.probability;
  EXPECT_NEAR(sum, 1, 1e-9);
  for (int i = 0; i < 6; ++i) {
    const double expected[] = {0.04, 0.04, 0.07, 0.07, 0.1, 0.1};
    EXPECT_NEAR(HeightOf(block, (*rests)[static_cast<std::size_t>(i)]), expected[i], 1e-4) << i;
  }
}

TEST(RestingPoses, APencilDoesNotStandUpOften) {
  const TriangleMesh pencil = BoxSolid({0, 0, 0}, {0.008F, 0.009F, 0.2F});
  const auto rests = RestingPoses(pencil, 0.05);
  ASSERT_THAT(rests, IsOk());
  EXPECT_EQ(rests->size(), 4U);
  for (const RestingPose& rest : *rests) EXPECT_LT(HeightOf(pencil, rest), 0.01);
}

TEST(RestingPoses, ACanStandsOnItsEndsOrLies) {
  const TriangleMesh can = CylinderSolid({0, 0}, 0.035F, 0, 0.1F);
  const auto rests = RestingPoses(can, 0.05);
  ASSERT_THAT(rests, IsOk());
  int standing = 0;
  for (const RestingPose& rest : *rests) standing += HeightOf(can, rest) > 0.09;
  EXPECT_EQ(standing, 2);
}

TEST(RestingPoses, NothingDoesNotRest) {
  EXPECT_THAT(RestingPoses({}, 0), StatusIs(absl::StatusCode::kInvalidArgument));
}

}  // namespace
}  // namespace graspdb::client
