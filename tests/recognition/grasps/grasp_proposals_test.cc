#include "recognition/grasps/grasp_proposals.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

namespace graspdb::recognition {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr double kPi = std::numbers::pi;

TaughtGrasp Grasp(const std::string& id, int priority) {
  TaughtGrasp grasp;
  grasp.id = id;
  grasp.priority = priority;
  grasp.object_tcp.translation() = Eigen::Vector3d(0.05, 0, 0.1);
  return grasp;
}

std::vector<std::string> IdsOf(const std::vector<GraspProposal>& proposals) {
  std::vector<std::string> out;
  out.reserve(proposals.size());
  for (const GraspProposal& p : proposals) out.push_back(p.grasp.id);
  return out;
}

TEST(DeclaredTurns, FollowTheSymmetryTheSmallestFirst) {
  EXPECT_THAT(DeclaredTurns(1), ElementsAre(0));
  EXPECT_THAT(DeclaredTurns(2), ElementsAre(0, DoubleNear(kPi, 1e-12)));
  EXPECT_THAT(DeclaredTurns(4), ElementsAre(0, DoubleNear(kPi / 2, 1e-12),
                                            DoubleNear(-kPi / 2, 1e-12), DoubleNear(kPi, 1e-12)));
  EXPECT_THAT(DeclaredTurns(0), SizeIs(12));
}

TEST(DeclaredTurns, AreAtMostTwelveThatTheSymmetryAllows) {
  const std::vector<double> turns = DeclaredTurns(30);
  EXPECT_THAT(turns, SizeIs(12));
  for (const double turn : turns) {
    EXPECT_NEAR(std::remainder(turn, 2 * kPi / 30), 0, 1e-9) << turn;
  }
}

TEST(ProposeGrasps, EveryGraspOnceForEachTurnThePriorityFirst) {
  TaughtStablePose pose{"pose", 2, {Grasp("low", 1), Grasp("high", 3)}};
  const Pose world_object(Eigen::Translation3d(0.2, 0.1, 0));
  const auto proposals = ProposeGrasps(pose, world_object, std::nullopt);
  EXPECT_THAT(IdsOf(proposals), ElementsAre("high", "high", "low", "low"));
  EXPECT_NEAR(proposals[0].world_tcp.translation().x(), 0.25, 1e-12);
  EXPECT_NEAR(proposals[1].world_tcp.translation().x(), 0.15, 1e-12);
}

TEST(SuccessRate, BeginsAtNineInTenAndFollowsReports) {
  EXPECT_DOUBLE_EQ(SuccessRate({}), 0.9);
  EXPECT_LT(SuccessRate({.picked = 0, .missed = 1, .slipped = 0}), 0.9);
  EXPECT_GT(SuccessRate({.picked = 1, .missed = 0, .slipped = 0}), 0.9);
  EXPECT_NEAR(SuccessRate({.picked = 30'000, .missed = 10'000, .slipped = 0}), 0.75, 1e-3);
  EXPECT_NEAR(SuccessRate({.picked = 30'000, .missed = 0, .slipped = 10'000}), 0.75, 1e-3);
}

TEST(ProposeGrasps, SuccessfulGraspsComeFirstWithinAPriority) {
  TaughtStablePose pose{"pose", 1, {Grasp("fails", 1), Grasp("holds", 1), Grasp("wanted", 2)}};
  pose.grasps[0].picks = {.picked = 4, .missed = 3, .slipped = 3};
  pose.grasps[1].picks = {.picked = 10, .missed = 0, .slipped = 0};
  pose.grasps[2].picks = {.picked = 0, .missed = 50, .slipped = 0};
  EXPECT_THAT(IdsOf(ProposeGrasps(pose, Pose::Identity(), std::nullopt)),
              ElementsAre("wanted", "holds", "fails"));
}

TEST(ProposeGrasps, OneFailureKeepsTheOrderAndTwoChangeIt) {
  TaughtStablePose pose{"pose", 1, {Grasp("first", 1), Grasp("second", 1)}};
  pose.grasps[0].picks.missed = 1;
  EXPECT_THAT(IdsOf(ProposeGrasps(pose, Pose::Identity(), std::nullopt)),
              ElementsAre("first", "second"));
  pose.grasps[0].picks.slipped = 1;
  EXPECT_THAT(IdsOf(ProposeGrasps(pose, Pose::Identity(), std::nullopt)),
              ElementsAre("second", "first"));
  pose.grasps[1].picks = {.picked = 0, .missed = 2, .slipped = 0};
  EXPECT_THAT(IdsOf(ProposeGrasps(pose, Pose::Identity(), std::nullopt)),
              ElementsAre("first", "second"));
}

TEST(ProposeGrasps, NineteenSuccessesKeepTheOrderAndTwentyChangeIt) {
  TaughtStablePose pose{"pose", 1, {Grasp("first", 1), Grasp("second", 1)}};
  pose.grasps[1].picks.picked = 19;
  EXPECT_EQ(ProposeGrasps(pose, Pose::Identity(), std::nullopt)[0].grasp.id, "first");
  pose.grasps[1].picks.picked = 20;
  EXPECT_EQ(ProposeGrasps(pose, Pose::Identity(), std::nullopt)[0].grasp.id, "second");
}

TEST(ProposeGrasps, SuccessPrecedesTheSmallestTurn) {
  TaughtStablePose pose{"pose", 2, {Grasp("fails", 1), Grasp("holds", 1)}};
  pose.grasps[0].picks.missed = 10;
  EXPECT_THAT(IdsOf(ProposeGrasps(pose, Pose::Identity(), std::nullopt)),
              ElementsAre("holds", "holds", "fails", "fails"));
}

TEST(ProposeGrasps, ATurnedGraspReplacesAnUnreachableTaughtOne) {
  TaughtStablePose pose{"pose", 2, {Grasp("side", 1)}};
  const Box left{{-1, -1, -1}, {0, 1, 1}};
  const auto proposals = ProposeGrasps(pose, Pose::Identity(), left);
  ASSERT_THAT(proposals, SizeIs(1));
  EXPECT_NEAR(proposals[0].world_tcp.translation().x(), -0.05, 1e-12);
  pose.symmetry_order = 1;
  EXPECT_THAT(ProposeGrasps(pose, Pose::Identity(), left), IsEmpty());
}

TEST(ProposeGrasps, AFreeTurnHasStepsOfThirtyDegreesAndItsEnds) {
  TaughtStablePose pose{"pose", 1, {Grasp("rim", 1)}};
  pose.grasps[0].free_turn = FreeTurn{-kPi / 4, kPi / 6};
  const auto proposals = ProposeGrasps(pose, Pose::Identity(), std::nullopt);
  std::vector<double> turns;
  turns.reserve(proposals.size());
  for (const GraspProposal& p : proposals) {
    turns.push_back(std::atan2(p.world_tcp.translation().y(), p.world_tcp.translation().x()));
  }
  EXPECT_THAT(turns, ElementsAre(0, DoubleNear(-kPi / 6, 1e-9), DoubleNear(kPi / 6, 1e-9),
                                 DoubleNear(-kPi / 4, 1e-9)));
}

TEST(ProposeGrasps, TurnsOfBothSymmetryAndFreeTurnAreGivenOnce) {
  TaughtStablePose pose{"pose", 2, {Grasp("rim", 1)}};
  pose.grasps[0].free_turn = FreeTurn{-kPi, kPi};
  EXPECT_THAT(ProposeGrasps(pose, Pose::Identity(), std::nullopt), SizeIs(12));
}

}  // namespace
}  // namespace graspdb::recognition
