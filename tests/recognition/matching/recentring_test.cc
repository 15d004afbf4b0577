#include "recognition/matching/recentring.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/recognition/scenes/seen_from_above.h"

namespace graspdb::recognition {
namespace {

using Eigen::Vector3d;
using ::graspdb::testing::SeenFromAbove;

// A roof whose ridge of 12 cm goes along x: only its ends constrain its position along x.
OrientedCloud Roof() {
  const float slope = std::sqrt(0.5F);
  OrientedCloud out;
  for (int i = 0; i < 60; ++i) {
    for (int j = -15; j <= 15; ++j) {
      const float across = 0.002F * static_cast<float>(j);
      out.points.emplace_back(0.002F * static_cast<float>(i), across, 0.04F - std::abs(across));
      out.normals.emplace_back(0.0F, j < 0 ? -slope : slope, slope);
    }
  }
  return out;
}

Pose Along(double x) {
  Pose out = Pose::Identity();
  out.translation().x() = x;
  return out;
}

class RecentringTest : public ::testing::Test {
 protected:
  // The recentred pose from `x` m along the ridge, with scores of `score_at(x)`.
  template <typename ScoreAt>
  double RecentredX(double x, const InformationMatrix& information, const ScoreAt& score_at) const {
    const Judge judge = [&](const Pose& pose) {
      Evidence out;
      out.score = score_at(pose.translation().x());
      return out;
    };
    const Recentred refined = {Along(x), judge(Along(x))};
    return Recentre(model_, refined, information, judge).world_object.translation().x();
  }

  InformationMatrix WeakAlong(int direction, double weight) const {
    InformationMatrix out = 500 * InformationMatrix::Identity();
    out.topLeftCorner<3, 3>() *= std::pow(static_cast<double>(model_.radius_m), 2);
    out(direction, direction) = weight;
    return out;
  }

  const SurfaceModel model_{Roof(), 1};
};

TEST_F(RecentringTest, AWeakAxisMovesToTheMiddleOfTheBestScores) {
  // As good from -3 to 5 mm, and worse by 0.01 a millimetre beyond.
  const auto score_at = [](double x) { return 0.99 - 10 * std::max({0.0, -0.003 - x, x - 0.005}); };
  const InformationMatrix loose = WeakAlong(3, 0.01);
  EXPECT_NEAR(RecentredX(0, loose, score_at), 0.001, 2e-4);
  EXPECT_NEAR(RecentredX(0.008, loose, score_at), 0.001, 3e-4);
  EXPECT_NEAR(RecentredX(-0.006, loose, score_at), 0.001, 3e-4);
}

TEST_F(RecentringTest, AFirmerAxisMovesLess) {
  const auto score_at = [](double x) { return 0.99 - 10 * std::abs(x - 0.004); };
  const double firm = RecentredX(0, WeakAlong(3, 20), score_at);
  const double loose = RecentredX(0, WeakAlong(3, 1), score_at);
  EXPECT_LT(firm, loose);
  EXPECT_NEAR(loose, 0.004, 1e-4);
  EXPECT_EQ(RecentredX(0, WeakAlong(3, 400), score_at), 0);
}

TEST_F(RecentringTest, AWeakTurnIsRecentredAboutTheCenter) {
  const Vector3d center = model_.center.cast<double>();
  const double rim = static_cast<double>(model_.radius_m);
  const auto turn_of = [](const Pose& pose) {
    return std::atan2(pose.linear()(1, 0), pose.linear()(0, 0));
  };
  const Judge judge = [&](const Pose& pose) {
    Evidence out;
    out.score = 0.99 - 10 * rim * std::abs(turn_of(pose) - 0.05);
    return out;
  };
  const Recentred recentred = Recentre(model_, {Pose::Identity(), judge(Pose::Identity())},
                                       WeakAlong(2, 0.01 * rim * rim), judge);
  EXPECT_NEAR(turn_of(recentred.world_object), 0.05, 0.005);
  EXPECT_LT((recentred.world_object * center - center).norm(), 1e-9);
  EXPECT_EQ(recentred.evidence.score, judge(recentred.world_object).score);
}

TEST_F(RecentringTest, TheEndsOfARidgeOutweighItsResiduals) {
  const SeenFromAbove seen(Roof());
  const RefinementTarget target = seen.Target(/*on_table=*/false);
  const Judge judge = [&](const Pose& pose) {
    return Verify(model_, pose, seen.columns, *seen.depth_buffer, {});
  };
  for (const double x : {-0.004, -0.003, -0.002, 0.002, 0.003, 0.004}) {
    const Pose refined = Refine(model_, target, Along(x), {}).world_object;
    const Recentred recentred = Recentre(model_, {refined, judge(refined)},
                                         InformationMatrixOf(model_, target, refined), judge);
    EXPECT_LT(recentred.world_object.translation().norm(), 0.8 * refined.translation().norm()) << x;
  }
}

}  // namespace
}  // namespace graspdb::recognition
