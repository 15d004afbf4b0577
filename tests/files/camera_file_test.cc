// Camera files of other programs as the sidecar of depth images: what they mean, or why not.
#include <gmock/gmock.h>

#include <string>

#include "absl/strings/str_cat.h"
#include "files/depth/depth_png.h"
#include "tests/files/temporary_folder.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::files {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::StatusIs;

constexpr char kPinhole[] =
    R"("width": 640, "height": 480, "fx": 525, "fy": 525, "cx": 319.5, "cy": 239.5)";

absl::StatusOr<DepthPngCamera> Read(const std::string& text) {
  const TemporaryFolder folder;
  return ReadIntrinsics(folder.Write("k.json", text));
}

// Of a file with a pinhole camera and other keys.
absl::StatusOr<DepthPngCamera> ReadWith(const std::string& keys) {
  return Read("{" + std::string(kPinhole) + ", " + keys + "}");
}

TEST(CameraFile, UnitsOfOtherProgramsAreUsed) {
  const struct {
    const char* keys;
    double unit_m;
  } cases[] = {
      {R"("depth_scale": 0.1)", 0.0001},                   // BOP
      {R"("depth_scale": 1.0)", 0.001},                    // BOP
      {R"("depth_scale": 0.00025)", 0.00025},              // RealSense L515
      {R"("depth_scale": 0.0010000000474974513)", 0.001},  // RealSense D400
      {R"("depth_scale": 1000.0)", 0.001},                 // Open3D
      {R"("depthScale": 0.1)", 0.0001},
      {R"("DepthMapFactor": 5000)", 0.0002},       // ORB-SLAM
      {R"("RGBD.DepthMapFactor": 5000)", 0.0002},  // ORB-SLAM3
      {R"("factor": 5000)", 0.0002},               // TUM
      {R"("factor_depth": 10000)", 0.0001},        // YCB-Video
      {R"("png_depth_scale": 6553.5)", 1 / 6553.5},
      {R"("depth": {"scale": 0.0001})", 0.0001},
      {R"("m_depthShift": 4000)", 0.00025},  // ScanNet
      {R"("counts_per_meter": 256)", 1 / 256.0},
      {R"("depth_unit": 0.0001)", 0.0001},
      {R"("depth_unit": "mm")", 0.001},
      {R"("depthUnitMm": 0.1)", 0.0001},
      {R"("depthUnitM": 0.0002, "factor": 5000)", 0.0002},
  };
  for (const auto& c : cases) {
    const auto camera = ReadWith(c.keys);
    ASSERT_THAT(camera, IsOk()) << c.keys;
    EXPECT_NEAR(camera->depth_unit_m, c.unit_m, 1e-6 * c.unit_m + 1e-12) << c.keys;
  }
}

TEST(CameraFile, UnitsThatMayMeanTwoAreRefusedByName) {
  const struct {
    const char* key;
    const char* value;
  } cases[] = {
      {"depth_scale", "0.01"},     {"depth_scale", "10"},        {"depth_scale", "0"},
      {"depth_scale", "-0.1"},     {"depth_scale", "\"a\""},     {"depth_scale", "null"},
      {"depth_scale", "[0.1, 1]"}, {"depthUnitM", "0.1"},        {"depthUnitM", "1"},
      {"depthUnitM", "1000"},      {"depth_unit", "1"},          {"depth_units", "1000"},
      {"depth_unit", "\"inch\""},  {"param-depthunits", "1000"}, {"lengthUnit", "\"m\""},
      {"disparity_scale", "0.1"},  {"depth_offset", "5"},
  };
  for (const auto& c : cases) {
    EXPECT_THAT(
        ReadWith(absl::StrCat("\"", c.key, "\": ", c.value)),
        StatusIs(absl::StatusCode::kInvalidArgument, AllOf(HasSubstr(c.key), HasSubstr("k.json"))))
        << c.key << " " << c.value;
  }
  EXPECT_THAT(ReadWith(R"("camera": {"z_scale": 2})"),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("camera.z_scale")));
  EXPECT_THAT(
      ReadWith(R"("depthUnitM": 0.001, "depth_scale": 0.1)"),
      StatusIs(absl::StatusCode::kInvalidArgument,
               AllOf(HasSubstr("depthUnitM"), HasSubstr("depth_scale"), HasSubstr("right one"))));
  EXPECT_THAT(ReadWith(R"("depth_scale": 10)"),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("depthUnitM")));
  EXPECT_THAT(ReadWith(R"("depthUnitM": 0.1)"),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("0.0001")));
}

TEST(CameraFile, KeysWithoutInfluenceAreIgnored) {
  EXPECT_THAT(ReadWith(R"("maker": "x", "serial": 17, "depth_offset": 0, "fps": 30, "date": null)"),
              IsOk());
  EXPECT_THAT(
      ReadWith(
          R"("distance": 3, "frame_id": "camera_depth_optical_frame", "made_by": "Omniverse 2")"),
      IsOk());
}

TEST(CameraFile, CameraMatricesOfAnyOrderAreRead) {
  for (const char* matrix :
       {// Open3D: column by column; OpenCV, ROS, BOP: row by row
        R"("intrinsic_matrix": [525, 0, 0, 0, 526, 0, 319, 239, 1])",
        R"("K": [525, 0, 319, 0, 526, 239, 0, 0, 1])",
        R"("cam_K": [[525, 0, 319], [0, 526, 239], [0, 0, 1]])",
        R"("camera_matrix": {"rows": 3, "cols": 3, "data": [525, 0, 319, 0, 526, 239, 0, 0, 1]})",
        R"("fx": 525, "fy": 526, "ppx": 319, "ppy": 239)"}) {
    const auto camera = Read(std::string(R"({"width": 640, "height": 480, )") + matrix + "}");
    ASSERT_THAT(camera, IsOk()) << matrix;
    EXPECT_EQ(camera->intrinsics.fx, 525) << matrix;
    EXPECT_EQ(camera->intrinsics.fy, 526) << matrix;
    EXPECT_EQ(camera->intrinsics.cx, 319) << matrix;
    EXPECT_EQ(camera->intrinsics.cy, 239) << matrix;
  }
}

TEST(CameraFile, WrongOrContradictingMatricesAreRefused) {
  for (const char* matrix : {R"("K": [525, 0, 319.5, 0, 525, 239.5, 0, 0])",
                             R"("K": [500, 0, 319.5, 0, 525, 239.5, 0, 0, 1])",
                             R"("K": [525, 2, 319.5, 0, 525, 239.5, 0, 0, 1])",
                             R"("K": [525, 0, 319.5, 0, 525, 239.5, 0, 0, 2])",
                             R"("color": {"K": [600, 0, 319.5, 0, 600, 239.5, 0, 0, 1]})"}) {
    EXPECT_THAT(ReadWith(matrix), StatusIs(absl::StatusCode::kInvalidArgument)) << matrix;
  }
}

TEST(CameraFile, DistortionIsReadWhateverItsName) {
  for (const char* keys :
       {R"("D": [0.1, -0.2, 0.001, 0.002, 0.05])",
        R"("dist_coeffs": [[0.1, -0.2, 0.001, 0.002, 0.05]])",
        R"("k1": 0.1, "k2": -0.2, "p1": 0.001, "p2": 0.002, "k3": 0.05)",
        R"("distortion_model": "plumb_bob", "d": [0.1, -0.2, 0.001, 0.002, 0.05])",
        R"("distortion": {"k1": 0.1, "k2": -0.2, "p1": 0.001, "p2": 0.002, "k3": 0.05})",
        R"("distortion_coefficients": {"data": [0.1, -0.2, 0.001, 0.002, 0.05]})",
        R"("model": "distortion.brown_conrady", "coeffs": [0.1, -0.2, 0.001, 0.002, 0.05])",
        R"("model": "Inverse Brown Conrady", "coeffs": [0.1, -0.2, 0.001, 0.002, 0.05])",
        R"("distCoeffs": [0.1, -0.2, 0.001, 0.002, 0.05, 0, 0, 0, 0, 0, 0, 0])"}) {
    const auto camera = ReadWith(keys);
    ASSERT_THAT(camera, IsOk()) << keys;
    EXPECT_THAT(camera->lens.coefficients, ElementsAre(0.1, -0.2, 0.001, 0.002, 0.05, 0, 0, 0))
        << keys;
  }
}

TEST(CameraFile, NoDistortionIsNone) {
  for (const char* keys :
       {R"("D": [0, 0, 0, 0, 0], "skew": 0)", R"("coeffs": [0, 0, 0, 0, 0], "model": "None")",
        R"("k1": 0, "k2": 0, "distortion_model": "plumb_bob")", R"("distortion": [])",
        R"("distortion": "none", "model": "Intel RealSense D435")"}) {
    const auto camera = ReadWith(keys);
    ASSERT_THAT(camera, IsOk()) << keys;
    EXPECT_FALSE(camera->lens.is_distorted()) << keys;
  }
}

TEST(CameraFile, LensesThatAreNotKnownAreRefusedWithAdvice) {
  for (const char* keys :
       {R"("skew": 0.1)", R"("D": [0.1])", R"("coeffs": [0.1, 0, 0, 0, 0])", R"("s1": 0.1)",
        R"("coeffs": [0.1, 0, 0, 0, 0], "model": "Modified Brown Conrady")",
        R"("distortion_model": "equidistant", "D": [0, 0, 0, 0])", R"("model": "Kannala Brandt4")",
        R"("D": [0.1, 0, 0, 0, 0, 0, 0, 0, 0.01])", R"("distortionParams": ["-0.006", "0.003"])",
        R"("distortion": "0.1 0.2 0 0 0")", R"("distortion_model": "FOV", "D": [0.9, 0, 0, 0])",
        R"("camera_model": "FOV", "k1": 0.9)", R"("radial": [0.1, 0.2])",
        R"("k1": 0.1, "D": [0.2, 0, 0, 0])", R"("left": {"D": [0.2]})"}) {
    EXPECT_THAT(ReadWith(keys),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("rectified")))
        << keys;
  }
}

TEST(CameraFile, DeclaredInvalidCountsAreRead) {
  EXPECT_THAT(ReadWith(R"("invalid_depth": 32001)")->invalid_counts, ElementsAre(32001));
  EXPECT_THAT(ReadWith(R"("noData": [1, 2])")->invalid_counts, ElementsAre(1, 2));
  for (const char* keys : {R"("invalid_value": -1)", R"("invalid_value": 0.5)",
                           R"("invalid_value": 65536)", R"("invalid_value": "NaN")"}) {
    EXPECT_THAT(ReadWith(keys),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("invalid_value")))
        << keys;
  }
}

TEST(CameraFile, APrincipalPointOrAFocalLengthInAnotherUnitIsRefused) {
  for (const char* text :
       {R"({"width": 640, "height": 480, "fx": 525, "fy": 525, "cx": 700, "cy": 239})",
        R"({"width": 640, "height": 480, "fx": 525, "fy": 525, "cx": 319, "cy": -1})",
        R"({"width": 640, "height": 480, "fx": 525, "fy": 525, "cx": 0, "cy": 0})",
        R"({"width": 640, "height": 480, "fx": 0.82, "fy": 1.09, "cx": 0.5, "cy": 0.5})"}) {
    EXPECT_THAT(Read(text), StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("in pixels")))
        << text;
  }
}

TEST(CameraFile, TheSameErrorIsReportedEveryTime) {
  std::string keys = R"("depth_scale": 10)";
  for (const char* key : {"a", "b", "c", "d1", "e"})
    absl::StrAppend(&keys, ", \"scale_", key, "\": 1");
  const auto first = ReadWith(keys);
  for (int i = 0; i < 20; ++i)
    EXPECT_EQ(ReadWith(keys).status().message(), first.status().message());
}

TEST(CameraFile, HostileFilesAreRefused) {
  std::string deep = "1";
  for (int i = 0; i < 50; ++i) deep = absl::StrCat(R"({"a": )", deep, "}");
  EXPECT_THAT(ReadWith(R"("x": )" + deep), StatusIs(absl::StatusCode::kInvalidArgument));
  EXPECT_THAT(ReadWith(R"("x": ")" + std::string(1 << 17, 'x') + "\""),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("larger than 64 KiB")));
  EXPECT_THAT(ReadWith("\"\\u001b[31mscale\": 3"),
              StatusIs(absl::StatusCode::kInvalidArgument, ::testing::Not(HasSubstr("\x1b"))));
}

}  // namespace
}  // namespace graspdb::files
