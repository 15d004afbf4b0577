// Range images of GenICam cameras as scans.
#include "client/cell/sensors/genicam/range_image.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "files/messages/scan_message.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::StatusIs;

constexpr float kNotMeasured = std::numeric_limits<float>::quiet_NaN();

template <typename T>
std::string Bytes(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

RangeGeometry Camera() {
  RangeGeometry out;
  out.output_mode = "CalibratedC";
  out.coordinate_system = "Cartesian";
  out.distance_unit = "Millimeter";
  for (RangeAxis& axis : out.axes) axis.scale = 1;
  out.focal_length = 500;
  out.principal_u = 1;
  out.principal_v = 0.5;
  return out;
}

// Of an image with two rows.
absl::StatusOr<files::ScanMessage> Read(RangeFormat format, const std::string& bytes, int width,
                                        const RangeGeometry& geometry) {
  return ScanOfRange({.format = format, .width = width, .height = 2, .data = bytes}, geometry,
                     std::nullopt);
}

TEST(RangeImage, CountsWithAScaleAreKept) {
  RangeGeometry camera = Camera();
  camera.axes[2].scale = 0.25;
  camera.axes[2].invalid = 7;
  camera.aspect_ratio = 1.5;
  const auto scan = Read(RangeFormat::kC16, Bytes<std::uint16_t>({4000, 7, 0, 65535}), 2, camera);
  ASSERT_THAT(scan, IsOk());
  const auto& image = std::get<v1::DepthImage>(*scan);
  EXPECT_DOUBLE_EQ(image.depth_unit_m(), 0.00025);
  EXPECT_THAT(*files::CountsFromMessage(image), ElementsAre(4000, 0, 0, 65535));
  EXPECT_EQ(image.intrinsics().fx(), 500);
  EXPECT_EQ(image.intrinsics().fy(), 750);
  EXPECT_EQ(image.intrinsics().cx(), 1);
  EXPECT_EQ(image.intrinsics().cy(), 0.5);
}

// Depths of a scan in metres; NaN: not measured.
std::vector<float> Depths(const absl::StatusOr<files::ScanMessage>& scan) {
  const auto points = files::PointsFromMessage(std::get<v1::DepthImage>(*scan));
  std::vector<float> out;
  for (const auto& point : *points) out.push_back(point.z());
  return out;
}

TEST(RangeImage, OffsetsAndNegativeScalesAreApplied) {
  RangeGeometry camera = Camera();
  camera.axes[2] = {.scale = -0.5, .offset = 1500, .invalid = 0};
  const auto scan = Read(RangeFormat::kC16, Bytes<std::uint16_t>({1000, 0, 2000, 4000}), 2, camera);
  ASSERT_THAT(scan, IsOk());
  const std::vector<float> depths = Depths(scan);
  EXPECT_NEAR(depths[0], 1, 2e-5);
  EXPECT_TRUE(std::isnan(depths[1]));
  EXPECT_NEAR(depths[2], 0.5, 2e-5);
  EXPECT_TRUE(std::isnan(depths[3])) << "behind the camera";
}

TEST(RangeImage, FloatsNeedNoScale) {
  RangeGeometry camera = Camera();
  camera.axes[2] = {};
  camera.distance_unit = "Inch";
  const auto scan =
      Read(RangeFormat::kC32f,
           Bytes<float>({100, kNotMeasured, -1, std::numeric_limits<float>::max()}), 2, camera);
  ASSERT_THAT(scan, IsOk());
  const std::vector<float> depths = Depths(scan);
  EXPECT_NEAR(depths[0], 2.54, 1e-4);
  for (std::size_t i = 1; i < 4; ++i) EXPECT_TRUE(std::isnan(depths[i])) << i;
}

TEST(RangeImage, DepthsThatNoCameraMeasuresAreNone) {
  RangeGeometry camera = Camera();
  camera.axes[2].scale = 1e-40;
  const auto scan = Read(RangeFormat::kC16, Bytes<std::uint16_t>({1, 2, 3, 65534}), 2, camera);
  ASSERT_THAT(scan, IsOk());
  for (const float depth : Depths(scan)) EXPECT_TRUE(std::isnan(depth)) << depth;
}

TEST(RangeImage, DisparitiesNeedFocalLengthAndBaseline) {
  RangeGeometry camera = Camera();
  camera.output_mode = "DisparityC";
  camera.distance_unit = "Pixel";
  camera.axes[2] = {.scale = 0.0625, .offset = 0, .invalid = 0};
  camera.baseline_m = 0.16;
  const auto scan = Read(RangeFormat::kC16, Bytes<std::uint16_t>({1280, 0, 640, 2560}), 2, camera);
  ASSERT_THAT(scan, IsOk());
  const std::vector<float> depths = Depths(scan);
  EXPECT_NEAR(depths[0], 1, 4e-5);  // 500 * 0.16 / 80
  EXPECT_TRUE(std::isnan(depths[1]));
  EXPECT_NEAR(depths[2], 2, 4e-5);
  EXPECT_NEAR(depths[3], 0.5, 4e-5);
  camera.baseline_m = 0;
  EXPECT_THAT(Read(RangeFormat::kC16, std::string(8, 'a'), 2, camera),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("Scan3dBaseline")));
}

TEST(RangeImage, PointsAreAnOrganisedCloud) {
  RangeGeometry camera = Camera();
  camera.output_mode = "CalibratedABC_Grid";
  camera.axes[0].offset = 10;
  camera.axes[2].invalid = -1;
  const auto scan = Read(RangeFormat::kAbc32f, Bytes<float>({100, 200, 1000, 0, 0, -1}), 1, camera);
  ASSERT_THAT(scan, IsOk());
  const auto& cloud = std::get<v1::PointCloud>(*scan);
  EXPECT_EQ(cloud.width(), 1);
  const auto points = files::PointsFromMessage(cloud);
  ASSERT_THAT(points, IsOk());
  EXPECT_TRUE(points->at(0).isApprox(Eigen::Vector3f(0.11F, 0.2F, 1)));
  EXPECT_TRUE(points->at(1).array().isNaN().all()) << "although only z has the value";
}

TEST(RangeImage, PointsOfIntegersHaveAScaleForEachAxis) {
  RangeGeometry camera = Camera();
  camera.output_mode = "CalibratedABC_Grid";
  camera.axes[0] = {.scale = 0.25, .offset = -8192, .invalid = std::nullopt};
  camera.axes[1] = {.scale = 0.25, .offset = -8192, .invalid = std::nullopt};
  camera.axes[2] = {.scale = 0.25, .offset = 0, .invalid = 65535};
  const auto scan =
      Read(RangeFormat::kAbc16, Bytes<std::uint16_t>({33168, 32768, 4000, 0, 0, 65535}), 1, camera);
  ASSERT_THAT(scan, IsOk());
  const auto points = files::PointsFromMessage(std::get<v1::PointCloud>(*scan));
  ASSERT_THAT(points, IsOk());
  EXPECT_TRUE(points->at(0).isApprox(Eigen::Vector3f(0.1F, 0, 1), 1e-6F));
  EXPECT_TRUE(points->at(1).array().isNaN().all());
}

TEST(RangeImage, GivenIntrinsicsReplaceThoseOfTheCamera) {
  RangeGeometry camera = Camera();
  camera.focal_length = 0;
  const std::string bytes = Bytes<std::uint16_t>({1, 2, 3, 4});
  const RangeImage image = {.format = RangeFormat::kC16, .width = 2, .height = 2, .data = bytes};
  EXPECT_THAT(ScanOfRange(image, camera, std::nullopt),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("Scan3dFocalLength")));
  recognition::CameraIntrinsics given = {
      .width = 2, .height = 2, .fx = 700, .fy = 700, .cx = 1, .cy = 1};
  const auto scan = ScanOfRange(image, camera, given);
  ASSERT_THAT(scan, IsOk());
  EXPECT_EQ(std::get<v1::DepthImage>(*scan).intrinsics().fx(), 700);
  given.width = 3;
  EXPECT_THAT(ScanOfRange(image, camera, given),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("3 x 2")));
}

TEST(RangeImage, WhatIsNoPinholeImageIsRefused) {
  const std::string bytes(8, 'a');
  const auto refused = [&bytes](const std::function<void(RangeGeometry&)>& change) {
    RangeGeometry camera = Camera();
    change(camera);
    return Read(RangeFormat::kC16, bytes, 2, camera);
  };
  const auto precondition = [](const char* text) {
    return StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr(text));
  };
  EXPECT_THAT(refused([](auto& c) { c.output_mode = "UncalibratedC"; }),
              precondition("Scan3dOutputMode"));
  EXPECT_THAT(refused([](auto& c) { c.output_mode = "RectifiedC"; }),
              precondition("Scan3dOutputMode"));
  EXPECT_THAT(refused([](auto& c) { c.output_mode = "CalibratedABC_Grid"; }),
              precondition("Scan3dOutputMode"));
  EXPECT_THAT(refused([](auto& c) { c.coordinate_system = "Spherical"; }),
              precondition("Scan3dCoordinateSystem"));
  EXPECT_THAT(refused([](auto& c) { c.distance_unit = "Pixel"; }),
              precondition("Scan3dDistanceUnit"));
  EXPECT_THAT(refused([](auto& c) { c.axes[2].scale.reset(); }),
              precondition("Scan3dCoordinateScale"));
  EXPECT_THAT(refused([](auto& c) { c.axes[2].scale = 0; }), precondition("no usable number"));
  EXPECT_THAT(refused([](auto& c) { c.axes[2].offset = kNotMeasured; }),
              precondition("no usable number"));
  EXPECT_THAT(refused([](auto& c) { c.focal_length = kNotMeasured; }),
              precondition("Scan3dFocalLength"));
}

TEST(RangeImage, OtherSizesAreDataLoss) {
  for (const std::size_t size : {0U, 7U, 9U, 12U}) {
    EXPECT_THAT(Read(RangeFormat::kC16, std::string(size, 'a'), 2, Camera()),
                StatusIs(absl::StatusCode::kDataLoss, HasSubstr("2 x 2")))
        << size;
  }
  EXPECT_THAT(Read(RangeFormat::kC16, std::string(8, 'a'), -2, Camera()),
              StatusIs(absl::StatusCode::kDataLoss, HasSubstr("-2")));
}

TEST(RangeImage, PixelFormatsAreThoseOfTheConvention) {
  EXPECT_EQ(RangeFormatOf(0x011000B8), RangeFormat::kC16);
  EXPECT_EQ(RangeFormatOf(0x026000C0), RangeFormat::kAbc32f);
  EXPECT_EQ(RangeFormatOf(0x01080001), std::nullopt);
}

}  // namespace
}  // namespace graspdb::client
