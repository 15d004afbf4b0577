// Frames for a load test without files.
#include <gtest/gtest.h>

#include <cstring>

#include "lab/commands/bench_frames.h"

namespace graspdb::lab {
namespace {

// The byte at which the middle pixel of a Kinect v2 begins.
constexpr std::size_t kMiddle = std::size_t{2} * (212 * 512 + 256);

TEST(SimulatedFrames, AreDepthImagesOfACalibratedCamera) {
  SimulatedFrames frames;
  frames.parts = {"wedge", "handle"};
  frames.count = 3;
  const auto requests = SimulateRequests(frames);
  ASSERT_TRUE(requests.ok()) << requests.status();
  ASSERT_EQ(requests->size(), 3U);
  for (const v1::RecognizeRequest& request : *requests) {
    ASSERT_TRUE(request.has_depth_image());
    const v1::DepthImage& image = request.depth_image();
    EXPECT_EQ(image.intrinsics().width(), 512);
    EXPECT_EQ(image.intrinsics().height(), 424);
    EXPECT_GT(image.intrinsics().fx(), 0);
    ASSERT_EQ(image.data().size(), 2U * 512 * 424);
    // The camera looks at the origin, 0.8 m away, where an object may be before the table.
    std::uint16_t middle = 0;
    std::memcpy(&middle, image.data().data() + kMiddle, sizeof(middle));
    EXPECT_NEAR(middle * image.depth_unit_m(), 0.7, 0.15);
    EXPECT_TRUE(request.has_sensor_pose());
    EXPECT_GT(request.region_of_interest().max().z(), 0);
  }
  EXPECT_NE((*requests)[0].depth_image().data(), (*requests)[1].depth_image().data());
}

TEST(SimulatedFrames, DependOnTheSeed) {
  SimulatedFrames frames;
  frames.parts = {"wedge"};
  frames.count = 1;
  frames.camera = rendering::KinectV1();
  const auto first = SimulateRequests(frames);
  const auto again = SimulateRequests(frames);
  frames.seed = 2;
  const auto other = SimulateRequests(frames);
  ASSERT_TRUE(first.ok() && again.ok() && other.ok());
  const auto bytes = [](const auto& requests) { return requests->front().depth_image().data(); };
  EXPECT_EQ(bytes(first).size(), 2U * 640 * 480);
  EXPECT_EQ(bytes(first), bytes(again));
  EXPECT_NE(bytes(first), bytes(other));
}

}  // namespace
}  // namespace graspdb::lab
