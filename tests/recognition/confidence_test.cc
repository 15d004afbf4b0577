#include "recognition/confidence.h"

#include <gtest/gtest.h>

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

TEST(DoubtsOf, AResidualLikeTheTablesNoiseIsExpected) {
  const SurfaceModel model = ModelOf(24, 0.0005F);
  const Evidence good{.scan_explained = 1, .model_seen = 1, .rms_m = 0.001};
  EXPECT_NEAR(DoubtsOf(good, model, 0.001, 0.008).residual, 1, 0.03);
  EXPECT_NEAR(DoubtsOf(good, model, 0.002, 0.008).residual, 0.5, 0.02);
}

TEST(DoubtsOf, ViewsThatWereTaughtApartExcuseAResidual) {
  const Evidence evidence{.scan_explained = 1, .model_seen = 1, .rms_m = 0.002};
  EXPECT_GT(DoubtsOf(evidence, ModelOf(24, 0.001F), 0.001, 0.008).residual, 1.8);
  EXPECT_LT(DoubtsOf(evidence, ModelOf(24, 0.002F), 0.001, 0.008).residual, 1);
}

TEST(DoubtsOf, NoiseAccountsForSomeOfWhatIsNotExplained) {
  const SurfaceModel model = ModelOf(24, 0);
  const Evidence evidence{.scan_explained = 0.95, .model_seen = 0.9, .rms_m = 0.002};
  const Doubt quiet = DoubtsOf(evidence, model, 0.0005, 0.008);
  const Doubt noisy = DoubtsOf(evidence, model, 0.002, 0.008);
  EXPECT_GT(quiet.scan, noisy.scan);
  EXPECT_GE(noisy.scan, 0);
  EXPECT_NEAR(quiet.model, 0.1, 1e-12);
}

TEST(Confidence, FallsWithEveryDoubt) {
  const double sure = Confidence({.scan = 0, .model = 0, .residual = 0.9});
  EXPECT_GT(sure, 0.95);
  EXPECT_LT(sure, 1);
  EXPECT_LT(Confidence({.scan = 0.2, .model = 0, .residual = 0.9}), sure);
  EXPECT_LT(Confidence({.scan = 0, .model = 0.2, .residual = 0.9}), 0.01);
  EXPECT_LT(Confidence({.scan = 0, .model = 0, .residual = 2.5}), 0.01);
}

TEST(Confidence, AnExactFitDoesNotMakeUpForWhatIsMissing) {
  EXPECT_LT(Confidence({.scan = 0, .model = 0.2, .residual = 0}), 0.1);
}

TEST(HeaviestDoubt, NamesWhatSpeaksMostAgainstIt) {
  EXPECT_EQ(HeaviestDoubt({.scan = 0.9, .model = 0, .residual = 1}), Gate::kScan);
  EXPECT_EQ(HeaviestDoubt({.scan = 0, .model = 0.3, .residual = 1}), Gate::kModel);
  EXPECT_EQ(HeaviestDoubt({.scan = 0.01, .model = 0.01, .residual = 3}), Gate::kResidual);
}

}  // namespace
}  // namespace graspdb::recognition
