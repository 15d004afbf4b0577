// Depth cameras of Video4Linux, with recorded buffers.
#include <gmock/gmock.h>

#include <memory>

#include "client/cell/sensors/video/v4l2_sensor.h"
#include "files/messages/scan_message.h"
#include "tests/client/cell/sensors/video/recorded_video.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using ::testing::ElementsAre;
using ::testing::Eq;
using ::testing::HasSubstr;
using testing::IsOk;
using ::testing::Optional;
using testing::StatusIs;

TEST(Z16, RowsMayBePadded) {
  const std::string bytes("\1\0\2\0??\3\0\4\1", 10);  // the last row ends with its pixels
  const auto counts = CountsOfZ16(bytes, {.width = 2, .height = 2, .bytes_per_row = 6});
  ASSERT_THAT(counts, IsOk());
  EXPECT_THAT(*counts, ElementsAre(1, 2, 3, 260));
}

TEST(Z16, IncompleteImagesAreDataLoss) {
  for (const std::size_t size : {0U, 3U, 4U, 9U}) {
    EXPECT_THAT(CountsOfZ16(std::string(size, 'a'), {.width = 2, .height = 2, .bytes_per_row = 6}),
                StatusIs(absl::StatusCode::kDataLoss, HasSubstr("2 x 2")))
        << size;
  }
  EXPECT_THAT(CountsOfZ16("", {.width = 2, .height = 2, .bytes_per_row = 3}),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("rows of 3")));
  EXPECT_THAT(CountsOfZ16("", {.width = 0, .height = 2, .bytes_per_row = 8}),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("0 x 2")));
}

TEST(Z16, ModelsHaveUnits) {
  EXPECT_THAT(DepthUnitOfModel("Intel(R) RealSense(TM) Depth Camera 435i"), Optional(Eq(0.001)));
  EXPECT_THAT(DepthUnitOfModel("Intel(R) RealSense(TM) Depth Camera 405"), Optional(Eq(0.0001)));
  EXPECT_THAT(DepthUnitOfModel("Intel RealSense L515"), Optional(Eq(0.00025)));
  EXPECT_EQ(DepthUnitOfModel("Integrated Camera"), std::nullopt);
  EXPECT_EQ(DepthUnitOfModel("Intel(R) RealSense(TM) Depth Ca"), std::nullopt) << "which one?";
}

class V4l2Test : public ::testing::Test {
 protected:
  V4l2Test() {
    settings_.silence = absl::Hours(1);
    settings_.intrinsics = {.width = 4, .height = 3, .fx = 5, .fy = 5, .cx = 1.5, .cy = 1};
  }

  absl::Status Open(const RecordedCamera& camera) {
    auto video = std::make_unique<RecordedVideo>(camera);
    video_ = video.get();
    auto sensor = OpenV4l2("/dev/video2", std::move(video), options_, settings_);
    if (!sensor.ok()) return sensor.status();
    sensor_ = *std::move(sensor);
    return absl::OkStatus();
  }

  // Stamped on arrival.
  static RecordedBuffer Image(char byte) { return {.bytes = std::string(24, byte), .flags = 0}; }

  static absl::Duration Clock() {
    return absl::FromChrono(MonotonicTime::Now().ToChrono().time_since_epoch());
  }

  absl::StatusOr<SensorFrame> Next(absl::Duration wait = absl::Minutes(2)) {
    return sensor_->Next(MonotonicTime::Now() + wait);
  }

  // The next frame with these data; others may be on their way.
  absl::StatusOr<SensorFrame> NextOf(const std::string& data) {
    for (;;) {
      absl::StatusOr<SensorFrame> frame = Next();
      if (!frame.ok() || std::get<v1::DepthImage>(frame->scan).data() == data) return frame;
    }
  }

  V4l2Options options_ = {.unit_m = {}, .latency = absl::ZeroDuration()};
  SensorSettings settings_;
  RecordedVideo* video_ = nullptr;  // of sensor_
  std::unique_ptr<DepthSensor> sensor_;
};

TEST_F(V4l2Test, GivesTheImagesOfTheDriver) {
  ASSERT_THAT(Open({.product = "Intel RealSense L515"}), IsOk());
  EXPECT_EQ(sensor_->Name(), "Intel RealSense L515 (V4L2) at /dev/video2");
  for (const char byte : {'a', 'b', 'c', 'd', 'e'}) {  // more than there are buffers
    video_->Repeat(Image(byte));
    const MonotonicTime before = MonotonicTime::Now();
    const auto frame = NextOf(std::string(24, byte));
    ASSERT_THAT(frame, IsOk());
    EXPECT_GE(frame->time, before);
    const auto& image = std::get<v1::DepthImage>(frame->scan);
    EXPECT_EQ(image.depth_unit_m(), 0.00025);
    EXPECT_EQ(image.intrinsics().cx(), 1.5);
  }
  EXPECT_TRUE(sensor_->IsReady());
}

TEST_F(V4l2Test, AGivenUnitReplacesThatOfTheModel) {
  options_.unit_m = 0.0002;
  ASSERT_THAT(Open({.product = "", .card = "Unknown"}), IsOk());
  video_->Repeat(Image('a'));
  const auto frame = Next();
  ASSERT_THAT(frame, IsOk());
  EXPECT_EQ(std::get<v1::DepthImage>(frame->scan).depth_unit_m(), 0.0002);
}

TEST_F(V4l2Test, SkipsDamagedAndIncompleteBuffers) {
  ASSERT_THAT(Open({}), IsOk());
  video_->Play({.bytes = std::string(24, 'x'), .flags = V4L2_BUF_FLAG_ERROR});
  video_->Play({.bytes = std::string(23, 'x'), .flags = 0});
  video_->Play({.bytes = "", .flags = 0});
  video_->Repeat(Image('a'));
  const auto frame = Next();
  ASSERT_THAT(frame, IsOk());
  EXPECT_EQ(std::get<v1::DepthImage>(frame->scan).data(), std::string(24, 'a'));
}

TEST_F(V4l2Test, TheKernelsTimestampCounts) {
  ASSERT_THAT(Open({}), IsOk());
  RecordedBuffer old = Image('a');
  old.flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
  old.timestamp = Clock() - absl::Minutes(1);
  video_->Repeat(old);
  EXPECT_THAT(Next(absl::Milliseconds(100)),
              StatusIs(absl::StatusCode::kDeadlineExceeded, HasSubstr("in time")));
  RecordedBuffer later = old;
  later.timestamp = Clock() + absl::Hours(1);
  video_->Repeat(later);
  const auto frame = Next();
  ASSERT_THAT(frame, IsOk());
  EXPECT_LE(frame->time, MonotonicTime::Now()) << "no frame is of the future";
}

TEST_F(V4l2Test, AnUnpluggedCameraIsUnavailable) {
  ASSERT_THAT(Open({}), IsOk());
  video_->Unplug();
  EXPECT_THAT(Next(), StatusIs(absl::StatusCode::kUnavailable, HasSubstr("unplugged")));
  EXPECT_FALSE(sensor_->IsReady());
}

TEST_F(V4l2Test, WhatCannotBeUsedIsRefused) {
  const auto precondition = [](const char* text) {
    return StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr(text));
  };
  EXPECT_THAT(Open({.capabilities = V4L2_CAP_META_CAPTURE}), precondition("Z16"));
  EXPECT_THAT(Open({.pixel_format = V4L2_PIX_FMT_YUYV}), precondition("Z16"));
  EXPECT_THAT(Open({.width = 640}), precondition("640 x 3"));
  EXPECT_THAT(Open({.product = "", .card = "Unknown"}), precondition("?unit=0.001"));
  EXPECT_THAT(Open({.stream_error = EBUSY}),
              StatusIs(absl::StatusCode::kUnavailable, HasSubstr("another program")));
  settings_.intrinsics.reset();
  EXPECT_THAT(Open({}), precondition("intrinsics=FILE"));
}

TEST(V4l2, APathThatIsNoDeviceIsRefused) {
  EXPECT_THAT(OpenVideo("/dev/video99"),
              StatusIs(absl::StatusCode::kUnavailable, HasSubstr("/dev/video99")));
  EXPECT_THAT(OpenVideo("/etc/hostname"),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("no device")));
  const auto null = OpenVideo("/dev/null");
  ASSERT_THAT(null, IsOk());
  SensorSettings settings;
  EXPECT_THAT(OpenV4l2("/dev/null", {}, settings),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("no video device")));
}

}  // namespace
}  // namespace graspdb::client
