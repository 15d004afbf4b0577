#include "client/teaching/turntable/turntable_coverage.h"

#include <gmock/gmock.h>

#include "files/messages/pose_message.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using ::graspdb::testing::IsOk;
using ::graspdb::testing::StatusIs;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

Eigen::Vector2d CoverageAxis() { return {0.1, -0.2}; }
Eigen::Vector3d Origin() { return {0.1, -0.2, 0.03}; }

std::vector<v1::View> ViewsAt(const std::vector<double>& azimuths_deg, double height_m = 0.03) {
  std::vector<v1::View> views;
  views.reserve(azimuths_deg.size());
  for (const double azimuth : azimuths_deg) {
    v1::View view;
    view.set_name("view at " + std::to_string(azimuth));
    view.set_point_count(100 + static_cast<int>(azimuth));
    *view.mutable_object_pose() = files::ToMessage(OnTurntable(CoverageAxis(), height_m, azimuth));
    views.push_back(view);
  }
  return views;
}

TEST(OnTurntable, ThePointOnTheAxisStaysAndTheOthersGoRoundCounterClockwise) {
  const auto start = OnTurntable(CoverageAxis(), 0.03, 0);
  const auto quarter = OnTurntable(CoverageAxis(), 0.03, 90);
  EXPECT_TRUE((quarter * Eigen::Vector3d::Zero()).isApprox(Origin(), 1e-12));
  EXPECT_TRUE(
      (start * Eigen::Vector3d(1, 0, 0)).isApprox(Origin() + Eigen::Vector3d(1, 0, 0), 1e-12));
  EXPECT_TRUE(
      (quarter * Eigen::Vector3d(1, 0, 0)).isApprox(Origin() + Eigen::Vector3d(0, 1, 0), 1e-12));
}

TEST(TurntableCoverage, ViewsAreFoundAgainByTheirAzimuth) {
  auto coverage = TurntableCoverage::Create(60);
  ASSERT_THAT(coverage, IsOk());
  ASSERT_THAT(coverage->Add(ViewsAt({0, 120, 300, 20}), Origin(), false), IsOk());
  EXPECT_THAT(coverage->Missing(), ElementsAre(1, 3, 4));
  EXPECT_EQ(coverage->Ring(), "[#.#..#]  taught 3 of 6, and 1 between these steps");
  EXPECT_EQ(coverage->MissingText(), "60, 180, 240 degrees");
}

TEST(TurntableCoverage, ViewsOfAClockwiseTurntableAreFoundToo) {
  auto coverage = TurntableCoverage::Create(60);
  ASSERT_THAT(coverage, IsOk());
  ASSERT_THAT(coverage->Add(ViewsAt({0, -60, -300}), Origin(), true), IsOk());
  EXPECT_THAT(coverage->Missing(), ElementsAre(2, 3, 4));
}

TEST(TurntableCoverage, NothingTaughtNothingMissing) {
  auto coverage = TurntableCoverage::Create(20);
  ASSERT_THAT(coverage, IsOk());
  EXPECT_EQ(coverage->Ring(), "[..................]  taught 0 of 18");
  EXPECT_EQ(coverage->MissingText(), "0 to 340 degrees");
  for (int step = 0; step < 18; ++step) coverage->Set(step, {});
  EXPECT_EQ(coverage->MissingText(), "");
}

TEST(TurntableCoverage, NeighboursAreTheNearestToBothSidesAroundTheTurn) {
  auto coverage = TurntableCoverage::Create(20);
  ASSERT_THAT(coverage, IsOk());
  EXPECT_EQ(coverage->NeighborPoints(3), 0);
  coverage->Set(17, {.name = "a", .point_count = 200});
  coverage->Set(2, {.name = "b", .point_count = 100});
  coverage->Set(3, {.name = "c", .point_count = 5000});
  EXPECT_EQ(coverage->NeighborPoints(0), 150);
  EXPECT_EQ(coverage->NeighborPoints(10), 0);  // too far
}

TEST(TurntableCoverage, ViewsOfAnotherPlaceAreRefusedWithTheirAxis) {
  auto coverage = TurntableCoverage::Create(20);
  ASSERT_THAT(coverage, IsOk());
  EXPECT_THAT(coverage->Add(ViewsAt({0}), Eigen::Vector3d(0.1, -0.19, 0.03), false),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("0.1000,-0.2000")));
  EXPECT_THAT(coverage->Add(ViewsAt({0}, 0), Origin(), false),
              StatusIs(absl::StatusCode::kFailedPrecondition));
  EXPECT_THAT(TurntableCoverage::Create(0.5), StatusIs(absl::StatusCode::kInvalidArgument));
  EXPECT_THAT(TurntableCoverage::Create(121), StatusIs(absl::StatusCode::kInvalidArgument));
}

}  // namespace
}  // namespace graspdb::client
