#include "recognition/verification/confidence.h"

#include <gtest/gtest.h>

#include <cmath>

namespace graspdb::recognition {
namespace {

SurfaceModel ModelOf(int views, float deviation_m) {
  OrientedCloud cloud;
  cloud.points.emplace_back(0.0F, 0.0F, 0.0F);
  cloud.normals.emplace_back(0.0F, 0.0F, 1.0F);
  SurfaceModel model(cloud, views);
  model.deviation_m = deviation_m;
  return model;
}

// All of the object is visible.
Evidence Perfect() {
  return {
      .scan_explained = 1, .model_seen = 1, .rms_m = 0.001, .confirmed = 1, .point_count = 1000};
}

TEST(NoiseAt, IsThatOfTheTable) {
  Segmentation seen;
  seen.table_noise_m = 0.0025;
  EXPECT_EQ(NoiseAt(seen, {}), 0.0025);
}

TEST(NoiseAt, GrowsWithTheDistanceWithoutATable) {
  const Segmentation seen;  // from the origin
  Segment segment;
  segment.centroid = {0, 0, 0.4};
  EXPECT_NEAR(NoiseAt(seen, segment), 0.0015, 1e-12);
  segment.centroid = {0, 0, 1.6};
  EXPECT_NEAR(NoiseAt(seen, segment), 0.003, 1e-12);
}

TEST(ConfidenceFeaturesOf, AResidualLikeTheNoiseIsExpected) {
  const SurfaceModel model = ModelOf(24, 0.0005F);
  EXPECT_LT(ConfidenceFeaturesOf(Perfect(), model, 0.001, 0.008).residual, 0.01);
  EXPECT_EQ(ConfidenceFeaturesOf(Perfect(), model, 0.002, 0.008).residual, 0);
  EXPECT_NEAR(ConfidenceFeaturesOf(Perfect(), model, 0.0005, 0.008).residual, 0.96, 0.01);
}

TEST(ConfidenceFeaturesOf, MisalignedTaughtViewsRaiseTheExpectedResidual) {
  Evidence evidence = Perfect();
  evidence.rms_m = 0.002;
  EXPECT_GT(ConfidenceFeaturesOf(evidence, ModelOf(24, 0.001F), 0.001, 0.008).residual, 0.8);
  EXPECT_EQ(ConfidenceFeaturesOf(evidence, ModelOf(24, 0.002F), 0.001, 0.008).residual, 0);
}

TEST(ConfidenceFeaturesOf, NoiseAccountsForSomeUnexplainedPoints) {
  const SurfaceModel model = ModelOf(24, 0);
  Evidence evidence = Perfect();
  evidence.scan_explained = 0.95;
  const ConfidenceFeatures quiet = ConfidenceFeaturesOf(evidence, model, 0.0005, 0.008);
  const ConfidenceFeatures noisy = ConfidenceFeaturesOf(evidence, model, 0.002, 0.008);
  EXPECT_GT(quiet.scan, noisy.scan);
  EXPECT_GE(noisy.scan, 0);
}

TEST(ConfidenceFeaturesOf, HiddenOrUnmeasuredSurfaceDoesNotContradict) {
  const SurfaceModel model = ModelOf(24, 0);
  Evidence evidence = Perfect();
  evidence.confirmed = 0.6;
  evidence.unmeasured = 0.2;
  EXPECT_EQ(ConfidenceFeaturesOf(evidence, model, 0.001, 0.008).contradicted, 0);
  EXPECT_EQ(ConfidenceFeaturesOf(evidence, model, 0.001, 0.008).unseen, 0);
  evidence.contradicted = 0.2;
  EXPECT_NEAR(ConfidenceFeaturesOf(evidence, model, 0.001, 0.008).contradicted, 0.25, 1e-12);
}

TEST(ConfidenceFeaturesOf, APieceOfTheObjectLacksEvidence) {
  Evidence evidence = Perfect();
  evidence.confirmed = 0.3;
  evidence.point_count = 150;
  const ConfidenceFeatures features = ConfidenceFeaturesOf(evidence, ModelOf(24, 0), 0.002, 0.008);
  EXPECT_NEAR(features.unseen, std::log(2.0), 1e-9);
  EXPECT_NEAR(features.little, std::log(2.0), 0.05);
  // A camera of half the noise gives as much information with a quarter of the points.
  EXPECT_EQ(ConfidenceFeaturesOf(evidence, ModelOf(24, 0), 0.001, 0.008).little, 0);
  evidence.point_count = 150 / 4;
  EXPECT_NEAR(ConfidenceFeaturesOf(evidence, ModelOf(24, 0), 0.001, 0.008).little, features.little,
              0.02);
}

TEST(ConfidenceFeaturesOf, AreFiniteWithoutEvidence) {
  const ConfidenceFeatures features = ConfidenceFeaturesOf({}, ModelOf(1, 0), 0.001, 0.008);
  EXPECT_TRUE(std::isfinite(features.unseen) && std::isfinite(features.little));
  EXPECT_EQ(features.contradicted, 0);
  EXPECT_LT(Confidence(features), 1e-6);
}

TEST(Confidence, FallsWithEveryFeature) {
  const double sure = Confidence({});
  EXPECT_GT(sure, 0.95);
  EXPECT_LT(sure, 1);
  EXPECT_LT(Confidence({.scan = 0.5}), 0.5);
  EXPECT_LT(Confidence({.contradicted = 0.2}), 0.5);
  EXPECT_LT(Confidence({.residual = 1.5}), 0.5);
  EXPECT_LT(Confidence({.unseen = std::log(2.0)}), 0.5);
  EXPECT_LT(Confidence({.little = std::log(4.0)}), 0.5);
}

TEST(HeaviestFeature, IsTheLargestContribution) {
  EXPECT_EQ(HeaviestFeature({.scan = 0.9}), Gate::kScan);
  EXPECT_EQ(HeaviestFeature({.scan = 0.1, .contradicted = 0.3}), Gate::kModel);
  EXPECT_EQ(HeaviestFeature({.scan = 0.01, .contradicted = 0.01, .residual = 2}), Gate::kResidual);
  EXPECT_EQ(HeaviestFeature({.scan = 0.1, .unseen = 0.7, .little = 0.7}), Gate::kLittleSeen);
}

TEST(MaxConfidence, BoundsTheConfidenceOfThatManyPoints) {
  for (const std::size_t count : {60U, 150U, 400U}) {
    for (const int views : {1, 24, 400}) {
      for (const float deviation : {0.0F, 0.001F, 0.004F}) {
        Evidence evidence = Perfect();
        evidence.rms_m = 0;
        evidence.point_count = count;
        const ConfidenceFeatures features =
            ConfidenceFeaturesOf(evidence, ModelOf(views, deviation), 0.002, 0.008);
        EXPECT_LE(Confidence(features), MaxConfidence(count, 0.002)) << count << " " << views;
      }
    }
  }
}

TEST(MaxConfidence, GrowsWithThePointsAndFallsWithTheNoise) {
  EXPECT_LT(MaxConfidence(60, 0.002), 0.5);
  EXPECT_GT(MaxConfidence(400, 0.002), 0.9);
  EXPECT_LT(MaxConfidence(200, 0.003), MaxConfidence(200, 0.002));
}

}  // namespace
}  // namespace graspdb::recognition
