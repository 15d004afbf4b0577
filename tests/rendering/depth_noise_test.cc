#include "rendering/camera/depth_noise.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "rendering/camera/depth_camera.h"

namespace graspdb::rendering {
namespace {

constexpr int kPixels = 100000;

IdealFrame Flat(float depth, float incidence) {
  return {.width = kPixels,
          .height = 1,
          .depth_m = std::vector<float>(kPixels, depth),
          .incidence_rad = std::vector<float>(kPixels, incidence),
          .surface = std::vector<std::int32_t>(kPixels, 0)};
}

// Mean and standard deviation of the pixels that are measured, and their share.
struct Spread {
  double mean = 0;
  double deviation = 0;
  double share = 0;
};

Spread SpreadOf(const DepthNoise& noise, float depth, float incidence) {
  IdealFrame frame = Flat(depth, incidence);
  ApplyNoise(noise, 5, frame);
  double sum = 0;
  double squares = 0;
  int count = 0;
  for (const float z : frame.depth_m) {
    if (z <= 0) continue;
    sum += z - depth;
    squares += (z - depth) * (z - depth);
    ++count;
  }
  const double mean = sum / count;
  return {.mean = mean + depth,
          .deviation = std::sqrt(squares / count - mean * mean),
          .share = count / static_cast<double>(kPixels)};
}

TEST(DepthNoise, HasThePublishedDeviations) {
  const AxialNoise v1 = KinectV1().noise.axial;
  EXPECT_NEAR(AxialDeviation(v1, 0.8, 0), 0.0012 + 0.0019 * 0.16, 1e-9);
  EXPECT_NEAR(AxialDeviation(v1, 3, 0), 0.0012 + 0.0019 * 6.76, 1e-9);
  const AxialNoise v2 = KinectV2().noise.axial;
  EXPECT_NEAR(AxialDeviation(v2, 0.8, 0), 0.001292, 1e-6);
  EXPECT_NEAR(AxialDeviation(v2, 2, 0), 0.0017, 1e-6);
  for (const AxialNoise& noise : {v1, v2}) {
    EXPECT_GT(AxialDeviation(noise, 1, 1.4), 1.5 * AxialDeviation(noise, 1, 0.2));
    EXPECT_LE(AxialDeviation(noise, 1, std::numbers::pi / 2), 0.05);
  }
}

TEST(DepthNoise, MeasuredSpreadFollowsTheModel) {
  for (DepthNoise noise : {KinectV1().noise, KinectV2().noise}) {
    noise.disparity_steps_m = 0;
    double last = 0;
    for (const float depth : {1.0F, 1.5F, 2.5F, 4.0F}) {
      const Spread spread = SpreadOf(noise, depth, 0.3F);
      const double expected = AxialDeviation(noise.axial, depth, 0.3F);
      EXPECT_NEAR(spread.deviation, expected, 0.02 * expected);
      EXPECT_NEAR(spread.mean, depth, 0.02 * expected);
      EXPECT_EQ(spread.share, 1);
      EXPECT_GT(spread.deviation, last);
      last = spread.deviation;
    }
    noise.scale = 2;
    EXPECT_NEAR(SpreadOf(noise, 1, 0).deviation, 2 * AxialDeviation(noise.axial, 1, 0), 0.0001);
  }
}

TEST(DepthNoise, LosesGrazingPixelsWithGrowingProbability) {
  const DepthNoise noise = KinectV2().noise;
  const auto share = [&noise](double deg) {
    return SpreadOf(noise, 1, static_cast<float>(deg * std::numbers::pi / 180)).share;
  };
  EXPECT_EQ(share(69.9), 1);
  EXPECT_NEAR(share(74), 1 - 4.0 / 15, 0.01);
  EXPECT_NEAR(share(80), 1 - 10.0 / 15, 0.01);
  IdealFrame frame = Flat(1, static_cast<float>(85.1 * std::numbers::pi / 180));
  ApplyNoise(noise, 5, frame);
  EXPECT_THAT(frame.depth_m, testing::Each(0.0F));
  EXPECT_THAT(frame.surface, testing::Each(kNoSurface));
}

TEST(DepthNoise, QuantizesDisparity) {
  DepthNoise noise = KinectV1().noise;
  IdealFrame frame = Flat(0.8F, 0);
  ApplyNoise(noise, 5, frame);
  const std::set<float> depths(frame.depth_m.begin(), frame.depth_m.end());
  EXPECT_LT(depths.size(), 12U);
  EXPECT_NEAR(*std::next(depths.begin()) - *depths.begin(),
              *depths.begin() * *depths.begin() / noise.disparity_steps_m, 1e-4);
}

TEST(DepthNoise, FlyingPixelsLieBetweenTheSurfacesAtAJump) {
  DepthNoise noise;
  noise.flying_chance = 1;
  IdealFrame frame = Flat(1, 0);
  for (std::size_t i = kPixels / 2; i < kPixels; ++i) frame.depth_m[i] = 2;
  ApplyNoise(noise, 6, frame);
  int flying = 0;
  for (std::size_t i = 0; i < kPixels; ++i) {
    const bool at_jump = i == kPixels / 2 || i == kPixels / 2 - 1;
    if (frame.surface[i] != kFlyingPixel) continue;
    EXPECT_TRUE(at_jump) << i;
    EXPECT_GE(frame.depth_m[i], 1);
    EXPECT_LE(frame.depth_m[i], 2);
    ++flying;
  }
  EXPECT_LE(flying, 2);
  int seeds_with_flying = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    IdealFrame again = {
        .width = 2, .height = 1, .depth_m = {1, 2}, .incidence_rad = {0, 0}, .surface = {0, 1}};
    ApplyNoise(noise, seed, again);
    seeds_with_flying += again.surface[0] == kFlyingPixel ? 1 : 0;
  }
  EXPECT_GT(seeds_with_flying, 2) << "one neighbour of four is across the jump";
  EXPECT_LT(seeds_with_flying, 25);
}

TEST(DepthNoise, ScaleZeroIsAnIdealCamera) {
  DepthNoise noise = KinectV1().noise;
  noise.scale = 0;
  noise.flying_chance = 1;
  IdealFrame frame = Flat(0.8F, 1.55F);
  ApplyNoise(noise, 5, frame);
  EXPECT_THAT(frame.depth_m, testing::Each(0.8F));
}

}  // namespace
}  // namespace graspdb::rendering
