// Objects that explain a cluster together.
#include "recognition/scene/explained_clusters.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

namespace graspdb::recognition {
namespace {

using ::testing::ElementsAre;

// One row of 100 pixels, all of one cluster.
class ExplainedClustersTest : public ::testing::Test {
 protected:
  ExplainedClustersTest() {
    frame_.camera.width = kPixels;
    frame_.camera.height = 1;
    frame_.depth.assign(kPixels, 1);
    frame_.role.assign(kPixels, PixelRole::kObject);
    clusters_ = {std::vector<int>(kPixels, 0), {kPixels}, {0}};
  }

  // An object on the pixels from `begin` up to `end`.
  static ClusterCandidate On(std::size_t begin, std::size_t end, float log_odds,
                             double confidence = 0.95) {
    Pixels pixels(end - begin);
    std::iota(pixels.begin(), pixels.end(), begin);
    return {std::move(pixels), confidence, log_odds};
  }

  std::vector<bool> Which(const std::vector<std::optional<ClusterCandidate>>& candidates) const {
    return WhichExplainClusters(frame_, clusters_, candidates, {});
  }

  static constexpr std::size_t kPixels = 100;
  Frame frame_;
  ClusterPixels clusters_;
};

TEST_F(ExplainedClustersTest, TwoObjectsExplainItTogether) {
  EXPECT_THAT(Which({On(0, 60, 1), std::nullopt, On(58, 100, 2)}), ElementsAre(true, false, true));
}

TEST_F(ExplainedClustersTest, AnObjectBesideSomethingUnknownExplainsNoCluster) {
  EXPECT_THAT(Which({On(0, 60, 1), On(60, 90, 2)}), ElementsAre(false, false));
}

TEST_F(ExplainedClustersTest, OneObjectAloneMustExplainMoreOfIt) {
  EXPECT_THAT(Which({On(0, 97, 1)}), ElementsAre(false));
  EXPECT_THAT(Which({On(0, 60, 1), On(60, 97, 2)}), ElementsAre(true, true));
}

TEST_F(ExplainedClustersTest, TheMoreLikelyOfTwoInOnePlaceIsTaken) {
  EXPECT_THAT(Which({On(0, 100, 1), On(0, 100, 2)}), ElementsAre(false, true));
}

// A right object and something that resembles a taught one.
TEST_F(ExplainedClustersTest, OfSeveralEachNeedsMoreConfidence) {
  EXPECT_THAT(Which({On(0, 60, 1), On(60, 100, 2, 0.7)}), ElementsAre(true, false));
  EXPECT_THAT(Which({On(0, 100, 2, 0.7)}), ElementsAre(true));
}

TEST_F(ExplainedClustersTest, WhatAnAnswerExplainsAlreadyCounts) {
  std::fill_n(frame_.role.begin(), 60, PixelRole::kExplained);
  clusters_.explained = {60};
  EXPECT_THAT(Which({On(60, 100, 1)}), ElementsAre(true));
  EXPECT_THAT(Which({On(60, 100, 1, 0.7)}), ElementsAre(false));
}

TEST_F(ExplainedClustersTest, AnObjectMostlyBesideTheClusterIsNoneOfIts) {
  std::fill_n(clusters_.cluster_of.begin(), 70, -1);
  clusters_.count = {30};
  EXPECT_THAT(Which({On(0, 100, 1)}), ElementsAre(false));
}

}  // namespace
}  // namespace graspdb::recognition
