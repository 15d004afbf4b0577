// Effects of the settings of stable poses and of a request on an answer.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "recognition/recognizer.h"
#include "tests/recognition/scenes/counting_clouds.h"
#include "tests/recognition/scenes/taught_shapes.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::recognition {
namespace {

using ::graspdb::testing::CountingClouds;
using ::graspdb::testing::IsOk;
using ::graspdb::testing::TaughtShapes;
using ::testing::SizeIs;

class RecognizerSettingsTest : public ::testing::Test {
 protected:
  // The taught catalogue with changed stable poses.
  template <typename Change>
  CatalogueSnapshot Taught(const Change& change) const {
    CatalogueSnapshot out = taught_.snapshot();
    auto poses = *out.stable_poses;
    for (auto& [name, pose] : poses) {
      auto changed = std::make_shared<TaughtStablePose>(*pose);
      change(*changed);
      pose = std::move(changed);
    }
    out.stable_poses = std::make_shared<const decltype(poses)>(std::move(poses));
    return out;
  }

  TaughtShapes taught_;
  RecognitionParameters parameters_;
};

TEST_F(RecognizerSettingsTest, AStablePosesOwnThresholdApplies) {
  const Scan scan = TaughtShapes::See({TaughtShapes::Part("bracket", 0, 0, 7)});
  const CatalogueSnapshot strict = Taught([](TaughtStablePose& pose) { pose.min_score = 1; });
  std::optional<Gate> gate;
  double score = 0;
  const auto outcome = [&] {
    const auto found = Recognize(scan, strict, taught_, parameters_, [] { return false; });
    EXPECT_THAT(found, IsOk());
    gate = found->detections.at(0).rejected_by;
    score = found->detections.at(0).score;
    return found->outcome;
  };
  EXPECT_EQ(outcome(), RecognitionOutcome::kUnknownObject);
  EXPECT_EQ(gate, Gate::kMinScore);
  parameters_.matching.use_own_min_scores = false;
  EXPECT_EQ(outcome(), RecognitionOutcome::kOk);
  parameters_.matching.min_score = score + 1e-6;
  EXPECT_EQ(outcome(), RecognitionOutcome::kUnknownObject);
  EXPECT_EQ(gate, Gate::kMinScore);
}

TEST_F(RecognizerSettingsTest, TheTurnsOfADeclaredSymmetryAreEquivalentPoses) {
  const Scan scan = TaughtShapes::See({TaughtShapes::Part("tower", 0.02, 0, 33)});
  for (const auto& [order, turns] : {std::pair(1, 0U), {4, 3U}, {0, 11U}}) {
    const CatalogueSnapshot declared =
        Taught([order = order](TaughtStablePose& pose) { pose.symmetry_order = order; });
    const auto found = Recognize(scan, declared, taught_, {}, [] { return false; });
    ASSERT_THAT(found, IsOk());
    const Detection& detection = found->detections.at(0);
    ASSERT_THAT(detection.equivalent_poses, SizeIs(turns)) << order;
    for (const Pose& pose : detection.equivalent_poses) {
      const Pose turn = detection.refined_pose.inverse() * pose;
      EXPECT_LT(turn.translation().norm(), 1e-9);
      EXPECT_NEAR(turn.linear()(2, 2), 1, 1e-9) << "about z";
      EXPECT_LT(turn.linear()(0, 0), 0.99) << "not the pose itself";
    }
  }
}

// Flattened parts, with nothing else in view.
TEST_F(RecognizerSettingsTest, WithoutAThresholdAnUnexplainedSegmentGetsTheNearestView) {
  parameters_.matching.min_score = 0;
  parameters_.matching.min_inlier_fraction = 0;
  for (const std::string object : {"bracket", "tower", "slab"}) {
    for (const double yaw : {7.0, 127.0, 236.0}) {
      const Scan frame = TaughtShapes::See({TaughtShapes::Part(object, 0, 0, yaw)});
      StageLog log;
      const auto seen = SegmentScan(
          frame, {}, {}, [] { return false; }, &log);
      ASSERT_THAT(seen, IsOk());
      Scan scan{
          .points = Transform(seen->world_sensor.inverse(), seen->segments.at(0).cloud.points),
          .world_sensor = frame.world_sensor,
          .region = std::nullopt,
          .segmented = true};
      for (Eigen::Vector3f& p : scan.points) p.y() *= 0.3F;
      const auto found =
          Recognize(scan, taught_.snapshot(), taught_, parameters_, [] { return false; });
      ASSERT_THAT(found, IsOk());
      const Detection& detection = found->detections.at(0);
      ASSERT_TRUE(detection.view);
      ASSERT_LT(detection.score, 0.01) << object << " " << yaw;
      EXPECT_FALSE(detection.registration.converged);
      EXPECT_EQ(detection.view->object, detection.candidates.at(0).view->object)
          << object << " " << yaw;
    }
  }
}

TEST_F(RecognizerSettingsTest, ASegmentTooSmallForAnyThresholdIsNotSearched) {
  const Scan frame = TaughtShapes::See({TaughtShapes::Part("bracket", 0, 0, 7)});
  StageLog log;
  const auto seen = SegmentScan(
      frame, {}, {}, [] { return false; }, &log);
  ASSERT_THAT(seen, IsOk());
  Points patch = Transform(seen->world_sensor.inverse(), seen->segments.at(0).cloud.points);
  std::ranges::sort(patch, {}, [at = patch[patch.size() / 2]](const Eigen::Vector3f& p) {
    return (p - at).squaredNorm();
  });
  patch.resize(65);
  const Scan scan{.points = patch,
                  .world_sensor = frame.world_sensor,
                  .region = std::nullopt,
                  .segmented = true};
  const double max_confidence = MaxConfidence(patch.size(), 0.0015);
  ASSERT_LT(max_confidence, 0.5);

  CountingClouds clouds(taught_);
  const auto found = Recognize(scan, taught_.snapshot(), clouds, parameters_, [] { return false; });
  ASSERT_THAT(found, IsOk());
  EXPECT_EQ(found->outcome, RecognitionOutcome::kUnknownObject);
  EXPECT_EQ(found->detections.at(0).rejected_by, Gate::kLittleSeen);
  EXPECT_THAT(found->detections.at(0).candidates, ::testing::Not(::testing::IsEmpty()));
  EXPECT_EQ(clouds.count(), 0);

  // Of a whole object, which would be accepted by default.
  parameters_.matching.min_score = 0.9999;
  const auto strictly = Recognize(TaughtShapes::See({TaughtShapes::Part("bracket", 0, 0, 7)}),
                                  taught_.snapshot(), clouds, parameters_, [] { return false; });
  ASSERT_THAT(strictly, IsOk());
  EXPECT_EQ(strictly->detections.at(0).rejected_by, Gate::kMinScore);
  EXPECT_EQ(clouds.count(), 0);
  parameters_.matching.min_score = 0.5;

  const CatalogueSnapshot lenient =
      Taught([max_confidence](TaughtStablePose& pose) { pose.min_score = max_confidence / 2; });
  ASSERT_THAT(Recognize(scan, lenient, clouds, parameters_, [] { return false; }), IsOk());
  EXPECT_GT(clouds.count(), 0);
}

}  // namespace
}  // namespace graspdb::recognition
