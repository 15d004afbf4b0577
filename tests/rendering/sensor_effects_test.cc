#include "rendering/camera/sensor_effects.h"

#include <gmock/gmock.h>

#include <cmath>

#include "rendering/camera/depth_camera.h"

namespace graspdb::rendering {
namespace {

constexpr int kWidth = 400;
constexpr int kHeight = 300;
constexpr double kFocal = 500;

// A wall with a nearer surface in the columns from `first` up to `end`.
IdealFrame Step(float near, float wall, int first, int end) {
  IdealFrame out{
      .width = kWidth, .height = kHeight, .depth_m = {}, .incidence_rad = {}, .surface = {}};
  for (int i = 0; i < kWidth * kHeight; ++i) {
    const bool is_near = i % kWidth >= first && i % kWidth < end;
    out.depth_m.push_back(is_near ? near : wall);
    out.surface.push_back(is_near ? 0 : kTableSurface);
  }
  out.incidence_rad.assign(out.depth_m.size(), 0);
  return out;
}

// Of the pixels in a column.
double ShareIn(const IdealFrame& frame, int column, float depth) {
  int count = 0;
  for (auto i = static_cast<std::size_t>(column); i < frame.depth_m.size(); i += kWidth) {
    count += frame.depth_m[i] == depth;
  }
  return static_cast<double>(count) / kHeight;
}

double DeviationAt(const SensorEffects& effects, float depth) {
  IdealFrame frame = Step(depth, depth, 0, 0);
  ApplyDepthEffects(effects, 3, frame);
  double squares = 0;
  for (const float z : frame.depth_m) squares += std::pow(static_cast<double>(z - depth), 2);
  return std::sqrt(squares / (kWidth * kHeight));
}

TEST(SensorEffects, AreOffByDefault) {
  IdealFrame frame = Step(0.7F, 1, 100, 200);
  const std::vector<float> before = frame.depth_m;
  ApplyEdgeEffects({}, kFocal, 1, frame);
  ApplyDepthEffects({}, 1, frame);
  EXPECT_EQ(frame.depth_m, before);
}

TEST(SensorEffects, FraysEdgesToBothSidesByTheDeviation) {
  IdealFrame frame = Step(0.7F, 1, 100, 200);
  ApplyEdgeEffects({.fray_px = 2, .fray_length_px = 3}, kFocal, 1, frame);
  // Rounded to whole pixels: the first column shows the wall where the shift is under half a pixel
  // to the left of it, as 40 % of normal numbers with deviation 2 are.
  EXPECT_NEAR(ShareIn(frame, 100, 1), 0.40, 0.08);
  EXPECT_NEAR(ShareIn(frame, 99, 0.7F), 0.40, 0.08);
  EXPECT_NEAR(ShareIn(frame, 102, 1), 0.106, 0.05);
  EXPECT_EQ(ShareIn(frame, 150, 0.7F), 1);
}

TEST(SensorEffects, ProjectorShadowLiesToTheRightOfANearerSurface) {
  IdealFrame frame = Step(0.5F, 1, 100, 200);
  ApplyEdgeEffects({.shadow_baseline_m = 0.075}, kFocal, 1, frame);
  const double disparity = kFocal * 0.075 / 0.5 - kFocal * 0.075;
  int lost = 0;
  for (int u = 0; u < kWidth; ++u) {
    if (ShareIn(frame, u, 0) == 0) continue;
    EXPECT_GE(u, 200);
    ++lost;
  }
  EXPECT_NEAR(lost, disparity, 1.5);
}

TEST(SensorEffects, LosesMorePixelsNearAJump) {
  IdealFrame frame = Step(0.7F, 1, 100, 200);
  ApplyEdgeEffects({.fray_length_px = 2, .edge_loss_chance = 0.6, .edge_loss_px = 6}, kFocal, 1,
                   frame);
  EXPECT_NEAR(ShareIn(frame, 100, 0), 0.6, 0.1);
  EXPECT_NEAR(ShareIn(frame, 103, 0), 0.3, 0.1);
  EXPECT_EQ(ShareIn(frame, 107, 0), 0);
}

TEST(SensorEffects, HolesHaveTheShareOfTheirDeviations) {
  IdealFrame frame = Step(0.7F, 0.7F, 0, 0);
  ApplyEdgeEffects({.hole_deviations = 1, .hole_length_px = 4}, kFocal, 1, frame);
  const auto lost = static_cast<double>(std::ranges::count(frame.depth_m, 0.0F));
  EXPECT_NEAR(lost / (kWidth * kHeight), 0.159, 0.015);
  EXPECT_EQ(std::ranges::count(frame.surface, kNoSurface), static_cast<std::ptrdiff_t>(lost));
}

TEST(SensorEffects, WarpsAndBumpsGrowWithTheSquareOfTheDepth) {
  for (const SensorEffects& effects :
       {SensorEffects{.warp_m = 0.003, .warp_length_px = 20}, SensorEffects{.bumps_m = 0.003}}) {
    EXPECT_NEAR(DeviationAt(effects, 1), 0.003, 0.0004);
    EXPECT_NEAR(DeviationAt(effects, 2), 0.012, 0.0016);
  }
  EXPECT_NEAR(DeviationAt({.scale = 1.01}, 0.8F), 0.008, 1e-5);
}

TEST(SensorEffects, PresetsAreDeterministicForASeed) {
  for (const std::string& name : SimulatedCameras()) {
    const auto model = SimulatedCameraOf(name);
    ASSERT_TRUE(model.ok());
    const auto frame_of = [&](std::uint64_t seed) {
      IdealFrame frame = Step(0.7F, 1, 100, 200);
      ApplyEdgeEffects(model->effects, kFocal, seed, frame);
      ApplyDepthEffects(model->effects, seed, frame);
      return frame.depth_m;
    };
    EXPECT_EQ(frame_of(1), frame_of(1));
    const bool has_effects = name != "v1" && name != "v2";
    EXPECT_EQ(frame_of(1) != frame_of(2), has_effects) << name;
  }
}

}  // namespace
}  // namespace graspdb::rendering
