// Frames of a program are checked, and only the newest of one camera is kept.

#include <gmock/gmock.h>

#include <cstring>
#include <functional>
#include <limits>

#include "client/cell/sensors/push/push_sensor.h"
#include "tests/client/cell/sensors/push/pushed_requests.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::StatusIs;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr absl::Duration kSilence = absl::Seconds(3);

absl::Time Noon() { return absl::FromUnixSeconds(1'700'000'000); }

absl::StatusOr<SensorFrame> Frame(const v1::PushFrameRequest& request) {
  return PushedFrame(request, Noon(), MonotonicTime::Now());
}

TEST(PushedFrame, AnImageKeepsItsPixelsAndItsAge) {
  const MonotonicTime now = MonotonicTime::Now();
  const v1::PushFrameRequest request = ImageRequest(Noon() - absl::Milliseconds(250));
  const auto frame = PushedFrame(request, Noon(), now);
  ASSERT_THAT(frame, IsOk());
  EXPECT_EQ(now - frame->time, absl::Milliseconds(250));
  const auto& image = std::get<v1::DepthImage>(frame->scan);
  EXPECT_EQ(image.data(), request.depth_image().data());
  EXPECT_EQ(image.intrinsics().fy(), 6);
  EXPECT_EQ(image.depth_unit_m(), 0.001);
  EXPECT_FALSE(frame->world_sensor);
}

TEST(PushedFrame, ACloudOfAnyLayoutIsRepacked) {
  v1::PushFrameRequest request;
  request.set_camera("left");
  v1::PointCloud& cloud = *request.mutable_cloud();
  *cloud.mutable_capture_time() = Stamp(Noon());
  cloud.set_point_stride(40);
  cloud.set_width(1);
  const auto add = [&cloud](const char* name, int offset,
                            v1::PackedElementField::NumericType type) {
    v1::PackedElementField& field = *cloud.add_fields();
    field.set_name(name);
    field.set_offset(offset);
    field.set_type(type);
  };
  add("z", 4, v1::PackedElementField::NUMERIC_TYPE_FLOAT32);
  add("x", 16, v1::PackedElementField::NUMERIC_TYPE_FLOAT64);
  add("rgb", 39, v1::PackedElementField::NUMERIC_TYPE_UNSPECIFIED);
  add("y", 24, v1::PackedElementField::NUMERIC_TYPE_FLOAT64);
  std::string data(80, '\0');
  for (std::size_t i = 0; i < 2; ++i) {
    const auto z = 1.F + static_cast<float>(i);
    const double xy[] = {0.25, kNaN};
    std::memcpy(data.data() + 40 * i + 4, &z, sizeof(z));
    std::memcpy(data.data() + 40 * i + 16, xy, sizeof(xy));
  }
  cloud.set_data(data);
  const auto frame = Frame(request);
  ASSERT_THAT(frame, IsOk());
  const auto points = files::PointsFromMessage(std::get<v1::PointCloud>(frame->scan));
  ASSERT_THAT(points, IsOk());
  ASSERT_EQ(points->size(), 2U);
  EXPECT_EQ(points->at(1).x(), 0.25F);
  EXPECT_TRUE(std::isnan(points->at(1).y()));
  EXPECT_EQ(points->at(1).z(), 2);
  EXPECT_EQ(std::get<v1::PointCloud>(frame->scan).width(), 1);
}

TEST(PushedFrame, AFrameWithoutMeasurementsIsValid) {
  EXPECT_THAT(Frame(ImageRequest(Noon(), 0)), IsOk());
  EXPECT_THAT(Frame(ImageRequest(Noon(), 65535)), IsOk());
}

TEST(PushedFrame, BadFramesAreRefusedWithTheField) {
  struct Case {
    const char* field;
    std::function<void(v1::PushFrameRequest&)> spoil;
    bool is_cloud = false;
  };
  const auto image = [](v1::PushFrameRequest& r) { return r.mutable_depth_image(); };
  const Case cases[] = {
      {"camera", [](auto& r) { r.clear_camera(); }},
      {"camera", [](auto& r) { r.set_camera(std::string(257, 'a')); }},
      {"scan", [](auto& r) { r.clear_depth_image(); }},
      {"capture_time", [&](auto& r) { image(r)->clear_capture_time(); }},
      {"no time", [&](auto& r) { image(r)->mutable_capture_time()->set_nanos(-1); }},
      {"no time",
       [&](auto& r) {
         image(r)->mutable_capture_time()->set_seconds(std::numeric_limits<std::int64_t>::min());
       }},
      {"future",
       [&](auto& r) { *image(r)->mutable_capture_time() = Stamp(Noon() + absl::Milliseconds(1)); }},
      {"ago",
       [&](auto& r) { *image(r)->mutable_capture_time() = Stamp(Noon() - absl::Seconds(61)); }},
      {"intrinsics", [&](auto& r) { image(r)->clear_intrinsics(); }},
      {"intrinsics", [&](auto& r) { image(r)->mutable_intrinsics()->set_fx(0); }},
      {"intrinsics", [&](auto& r) { image(r)->mutable_intrinsics()->set_cy(kNaN); }},
      {"depth_unit_m", [&](auto& r) { image(r)->set_depth_unit_m(1); }},
      {"depth_unit_m", [&](auto& r) { image(r)->set_depth_unit_m(kNaN); }},
      {"depth_image.data", [&](auto& r) { image(r)->mutable_data()->pop_back(); }},
      {"depth_image.data",
       [&](auto& r) {
         image(r)->mutable_intrinsics()->set_width(1 << 30);
         image(r)->mutable_intrinsics()->set_height(1 << 30);
       }},
      {"median", [&](auto& r) { image(r)->set_depth_unit_m(0.1); }},
      {"cloud.data", [](auto& r) { r.mutable_cloud()->clear_data(); }, true},
      {"cloud.data", [](auto& r) { r.mutable_cloud()->mutable_data()->push_back(0); }, true},
      {"point_stride", [](auto& r) { r.mutable_cloud()->set_point_stride(0); }, true},
      {"12 to 4096", [](auto& r) { r.mutable_cloud()->set_point_stride(4); }, true},
      {"point_stride", [](auto& r) { r.mutable_cloud()->set_point_stride(-12); }, true},
      {"cloud.fields[2].offset is",
       [](auto& r) { r.mutable_cloud()->mutable_fields(2)->set_offset(9); }, true},
      {"cloud.fields[2].offset is",
       [](auto& r) { r.mutable_cloud()->mutable_fields(2)->set_offset(-1); }, true},
      {"cloud.fields[0].offset is",
       [](auto& r) {
         r.mutable_cloud()->mutable_fields(0)->set_offset(std::numeric_limits<int>::max());
       },
       true},
      {"cloud.fields have no \"y\"",
       [](auto& r) { r.mutable_cloud()->mutable_fields(1)->set_name("v"); }, true},
      {"cloud.fields[1].type must be FLOAT32",
       [](auto& r) {
         r.mutable_cloud()->mutable_fields(1)->set_type(
             v1::PackedElementField::NUMERIC_TYPE_UNSPECIFIED);
       },
       true},
      {"cloud.width", [](auto& r) { r.mutable_cloud()->set_width(3); }, true},
      {"cloud.width", [](auto& r) { r.mutable_cloud()->set_width(-1); }, true},
      {"fields",
       [](auto& r) {
         for (int i = 0; i < 64; ++i) r.mutable_cloud()->add_fields();
       },
       true},
      {"millimetres",
       [](auto& r) {
         *r.mutable_cloud() = files::CloudMessage(recognition::Points(3, {0, 0, 800}), 0);
         *r.mutable_cloud()->mutable_capture_time() = Stamp(Noon());
       },
       true},
  };
  for (const Case& c : cases) {
    v1::PushFrameRequest request = c.is_cloud ? CloudRequest(Noon()) : ImageRequest(Noon());
    ASSERT_THAT(Frame(request), IsOk());
    c.spoil(request);
    EXPECT_THAT(Frame(request), StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr(c.field)));
  }
}

TEST(FrameReceiver, KeepsTheNewestFrameOnly) {
  FrameReceiver frames(kSilence, "");
  const MonotonicTime now = MonotonicTime::Now();
  const auto push = [&](int age_ms, std::uint16_t depth_mm) {
    return frames.Receive(ImageRequest(Noon() - absl::Milliseconds(age_ms), depth_mm), "test",
                          Noon(), now);
  };
  ASSERT_THAT(push(30, 700), IsOk());
  ASSERT_THAT(push(20, 800), IsOk());
  EXPECT_THAT(push(25, 900), StatusIs(absl::StatusCode::kAborted, HasSubstr("newer")));
  const auto frame = frames.Wait(now - absl::Seconds(1), now + absl::Hours(1));
  ASSERT_THAT(frame, IsOk());
  EXPECT_EQ(std::get<v1::DepthImage>(frame->scan).data(),
            ImageRequest(Noon(), 800).depth_image().data());
  EXPECT_THAT(frames.Wait(now - absl::Milliseconds(19), now),
              StatusIs(absl::StatusCode::kDeadlineExceeded, HasSubstr("in time")))
      << "exposed before the robot's motion ended";
}

TEST(FrameReceiver, AnotherCameraWaitsUntilTheFirstIsSilent) {
  FrameReceiver frames(kSilence, "");
  const MonotonicTime start = MonotonicTime::Now();
  v1::PushFrameRequest right = ImageRequest(Noon());
  right.set_camera("right");
  const auto push = [&](const v1::PushFrameRequest& request, absl::Duration after) {
    return frames.Receive(request, "test", Noon(), start + after);
  };
  ASSERT_THAT(push(ImageRequest(Noon()), absl::ZeroDuration()), IsOk());
  EXPECT_THAT(push(right, kSilence),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("camera left")));
  EXPECT_THAT(push(right, kSilence + absl::Milliseconds(1)), IsOk());
  EXPECT_THAT(push(ImageRequest(Noon()), kSilence + absl::Milliseconds(2)),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("camera right")));
}

TEST(FrameReceiver, IsReadyWhileFramesCome) {
  FrameReceiver frames(kSilence, "");
  EXPECT_FALSE(frames.IsReady());
  const MonotonicTime now = MonotonicTime::Now();
  ASSERT_THAT(frames.Receive(ImageRequest(Noon()), "test", Noon(), now - kSilence), IsOk());
  EXPECT_FALSE(frames.IsReady()) << "it has been silent since";
  ASSERT_THAT(frames.Receive(ImageRequest(Noon()), "test", Noon(), now + absl::Hours(1)), IsOk());
  EXPECT_TRUE(frames.IsReady());
}

}  // namespace
}  // namespace graspdb::client
