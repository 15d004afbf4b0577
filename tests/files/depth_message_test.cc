
#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "files/messages/scan_message.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::files {
namespace {

using ::testing::ElementsAre;
using testing::IsOk;
using testing::StatusIs;

constexpr recognition::CameraIntrinsics kCameraOfFive = {
    .width = 5, .height = 1, .fx = 100, .fy = 100, .cx = 2, .cy = 0};

TEST(FineDepthMessage, DepthsAreRoundedByAtMostEightMicrometresAMetre) {
  constexpr float kFar = 1.3F;
  const std::vector<float> depths = {0.5F, 0.812345F, 1.0F, 1.2999F, kFar};
  const auto points = PointsFromMessage(FineDepthMessage(depths, kCameraOfFive, kFar));
  ASSERT_THAT(points, IsOk());
  for (std::size_t i = 0; i < depths.size(); ++i) {
    EXPECT_NEAR((*points)[i].z(), depths[i], 8e-6 * kFar) << i;
  }
}

TEST(FineDepthMessage, WhatIsNotMeasuredOrFartherIsZero) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto counts = CountsFromMessage(
      FineDepthMessage(std::vector<float>{0, nan, 1.1F, 1, 0.5F}, kCameraOfFive, 1));
  ASSERT_THAT(counts, IsOk());
  EXPECT_THAT(*counts, ElementsAre(0, 0, 0, 65534, 32767));
  const auto none =
      CountsFromMessage(FineDepthMessage(std::vector<float>(5, nan), kCameraOfFive, 0));
  ASSERT_THAT(none, IsOk());
  EXPECT_THAT(*none, ElementsAre(0, 0, 0, 0, 0));
}

TEST(PointsFromMessage, PixelsLieOnTheirRays) {
  const auto points = PointsFromMessage(DepthMessage({500, 0, 0, 0, 1000}, kCameraOfFive, 0.001));
  ASSERT_THAT(points, IsOk());
  ASSERT_EQ(points->size(), 5U);
  EXPECT_TRUE((*points)[0].isApprox(Eigen::Vector3f(-0.01F, 0, 0.5F), 1e-5F));
  EXPECT_TRUE(std::isnan((*points)[1].z()));
  EXPECT_TRUE((*points)[4].isApprox(Eigen::Vector3f(0.02F, 0, 1), 1e-5F));
}

TEST(PointsFromMessage, ASaturatedCountIsNoMeasurement) {
  const auto points =
      PointsFromMessage(DepthMessage({500, 65535, 0, 0, 1000}, kCameraOfFive, 0.001));
  ASSERT_THAT(points, IsOk());
  EXPECT_TRUE(std::isnan((*points)[1].z()));
}

TEST(PointsFromMessage, AnInvalidImageIsRejected) {
  const v1::DepthImage good = DepthMessage({1, 2, 3, 4, 5}, kCameraOfFive, 0.001);
  v1::DepthImage image = good;
  image.mutable_data()->pop_back();
  EXPECT_THAT(PointsFromMessage(image), StatusIs(absl::StatusCode::kInvalidArgument));
  image = good;
  image.mutable_intrinsics()->set_fy(0);
  EXPECT_THAT(PointsFromMessage(image), StatusIs(absl::StatusCode::kInvalidArgument));
}

TEST(ContentId, IsOfEverythingThatMakesThePointsOfAnImage) {
  v1::View view;
  *view.mutable_depth_image() = DepthMessage({1, 2, 3, 4, 5}, kCameraOfFive, 0.001);
  const std::string id = ContentId(view);
  view.mutable_depth_image()->mutable_capture_time()->set_seconds(7);
  view.mutable_sensor_pose()->mutable_position()->set_x(1);
  EXPECT_EQ(ContentId(view), id);
  for (const auto& change : std::vector<std::function<void(v1::DepthImage&)>>{
           [](v1::DepthImage& image) { image.set_depth_unit_m(0.002); },
           [](v1::DepthImage& image) { image.mutable_intrinsics()->set_fx(101); },
           [](v1::DepthImage& image) { image.mutable_data()->front() = 'x'; }}) {
    v1::View other = view;
    change(*other.mutable_depth_image());
    EXPECT_NE(ContentId(other), id);
  }
}

}  // namespace
}  // namespace graspdb::files
