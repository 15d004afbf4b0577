// Aravis' fake camera of GigE Vision, opened as a sensor.
#include <gmock/gmock.h>

#include <cstring>

#include "client/cell/sensors/genicam/genicam_sensor.h"
#include "client/cell/sensors/kinds/open_sensor.h"
#include "files/messages/scan_message.h"
#include "tests/client/cell/sensors/genicam/fake_camera.h"
#include "tests/testing/own_network.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::StatusIs;

class GenicamTest : public ::testing::Test {
 protected:
  GenicamTest() { testing::EnterOwnNetwork(); }

  void SetUp() override {
    camera_ = std::make_unique<FakeGenicamCamera>();
    ASSERT_TRUE(camera_->IsRunning()) << "is another fake camera on 127.0.0.1?";
  }

  static MonotonicTime Later() { return MonotonicTime::Now() + absl::Minutes(2); }

  static v1::DepthImage Ramp() {
    std::vector<std::uint16_t> counts(std::size_t{64} * 48);
    for (std::size_t i = 0; i < counts.size(); ++i) counts[i] = static_cast<std::uint16_t>(i);
    return files::DepthMessage(
        counts, {.width = 64, .height = 48, .fx = 60, .fy = 61, .cx = 31.5, .cy = 23.5}, 0.0005);
  }

  // The next frame of the sensor that `spec` names.
  static absl::StatusOr<SensorFrame> Grab(const std::string& spec) {
    SensorSettings settings;
    settings.max_age = absl::Minutes(2);
    settings.silence = absl::Hours(1);
    auto sensor = OpenSensor(spec, settings);
    if (!sensor.ok()) return sensor.status();
    return (*sensor)->Next(Later());
  }

  std::unique_ptr<FakeGenicamCamera> camera_;
};

TEST_F(GenicamTest, GivesTheDepthImageOfTheCamera) {
  const v1::DepthImage ramp = Ramp();
  camera_->Show(ramp);
  const auto frame = Grab(std::string("genicam:") + FakeGenicamCamera::kId + "?latency=0");
  ASSERT_THAT(frame, IsOk());
  const auto& image = std::get<v1::DepthImage>(frame->scan);
  EXPECT_EQ(image.data(), ramp.data());
  EXPECT_DOUBLE_EQ(image.depth_unit_m(), 0.0005);
  EXPECT_EQ(image.intrinsics().width(), 64);
  EXPECT_EQ(image.intrinsics().height(), 48);
  EXPECT_EQ(image.intrinsics().fx(), 60);
  EXPECT_DOUBLE_EQ(image.intrinsics().fy(), 61);
  EXPECT_EQ(image.intrinsics().cx(), 31.5);
}

TEST_F(GenicamTest, GivesPointsInTheFormatOfTheOption) {
  RangeGeometry geometry;
  geometry.output_mode = "CalibratedABC_Grid";
  for (RangeAxis& axis : geometry.axes) axis.scale = 1;
  geometry.axes[0].offset = 50;
  geometry.axes[2].scale = 2;
  geometry.axes[2].invalid = 0;
  camera_->Describe(geometry);
  const float values[] = {100, 200, 300, 0, 0, 0};
  std::string bytes(sizeof(values), '\0');
  std::memcpy(bytes.data(), values, sizeof(values));
  camera_->Show(RangeFormat::kC16, 2, 1, bytes);
  const auto frame = Grab("genicam?format=Coord3D_ABC32f&latency=0");
  ASSERT_THAT(frame, IsOk());
  const auto points = files::PointsFromMessage(std::get<v1::PointCloud>(frame->scan));
  ASSERT_THAT(points, IsOk());
  ASSERT_EQ(points->size(), 2U);
  EXPECT_TRUE(points->at(0).isApprox(Eigen::Vector3f(0.15F, 0.2F, 0.6F)));
  EXPECT_TRUE(points->at(1).array().isNaN().all());
}

TEST_F(GenicamTest, AFormatWithoutDepthIsReplacedByOneWith) {
  RangeGeometry geometry;
  geometry.output_mode = "CalibratedABC_Grid";
  camera_->Describe(geometry);
  camera_->ShowMono8();
  const auto frame = Grab("genicam?latency=0");
  ASSERT_THAT(frame, IsOk());
  EXPECT_EQ(std::get<v1::PointCloud>(frame->scan).data().size(), 8U * 4 * 12);
}

TEST_F(GenicamTest, AFrameIsAsOldAsItsLatency) {
  camera_->Show(Ramp());
  SensorSettings settings;
  settings.silence = absl::Hours(1);
  const auto sensor =
      OpenGenicam("", {.pixel_format = "", .latency = absl::Milliseconds(200)}, settings);
  ASSERT_THAT(sensor, IsOk());
  EXPECT_THAT((*sensor)->Name(), HasSubstr("GD01"));
  const MonotonicTime before = MonotonicTime::Now();
  const auto frame = (*sensor)->Next(Later());
  ASSERT_THAT(frame, IsOk());
  EXPECT_GE(frame->time, before);
  EXPECT_GE(MonotonicTime::Now() - frame->time, absl::Milliseconds(200));
  EXPECT_TRUE((*sensor)->IsReady());
}

TEST_F(GenicamTest, UnusableSettingsAreReportedWhenItIsOpened) {
  RangeGeometry geometry;
  geometry.output_mode = "UncalibratedC";
  geometry.focal_length = 60;
  camera_->Describe(geometry);
  camera_->Show(RangeFormat::kC16, 8, 4, "");
  EXPECT_THAT(OpenGenicam("", {}, {}),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("Scan3dOutputMode")));
  EXPECT_THAT(OpenGenicam("", {.pixel_format = "Mono8"}, {}),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("Coord3D_C16")));
}

TEST_F(GenicamTest, AVanishedCameraIsUnavailable) {
  camera_->Show(Ramp());
  SensorSettings settings;
  settings.silence = absl::Hours(1);
  const auto sensor =
      OpenGenicam("", {.pixel_format = "", .latency = absl::ZeroDuration()}, settings);
  ASSERT_THAT(sensor, IsOk());
  ASSERT_THAT((*sensor)->Next(Later()), IsOk());
  camera_.reset();
  absl::StatusOr<SensorFrame> frame;
  do {
    frame = (*sensor)->Next(Later());
  } while (frame.ok());
  EXPECT_THAT(frame, StatusIs(absl::StatusCode::kUnavailable, HasSubstr("disconnected")));
  EXPECT_FALSE((*sensor)->IsReady());
}

TEST_F(GenicamTest, IsListed) {
  const auto ids = ListGenicam();
  ASSERT_THAT(ids, IsOk());
  EXPECT_THAT(*ids, Contains(std::string(FakeGenicamCamera::kId)));
}

TEST(Genicam, AMissingCameraIsUnavailable) {
  testing::EnterOwnNetwork();
  EXPECT_THAT(OpenGenicam("Vendor-0815", {}, {}),
              StatusIs(absl::StatusCode::kUnavailable, HasSubstr("sensors list")));
}

}  // namespace
}  // namespace graspdb::client
