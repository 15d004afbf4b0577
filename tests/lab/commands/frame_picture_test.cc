#include <gmock/gmock.h>

#include <algorithm>
#include <limits>

#include "lab/commands/eval_run.h"

namespace graspdb::lab {
namespace {

using recognition::OrientedCloud;
using recognition::Points;
using recognition::SurfaceModel;
using ::testing::Each;
using ::testing::Field;

constexpr float kFocal = 500;
constexpr float kWallM = 1;
constexpr float kPlateM = 0.8F;

// A wall before a camera of 640 x 480 pixels.
Points Wall() {
  Points out;
  for (int v = -240; v < 240; ++v) {
    for (int u = -320; u < 320; ++u) {
      out.push_back(Eigen::Vector3f(static_cast<float>(u), static_cast<float>(v), kFocal) * kWallM /
                    kFocal);
    }
  }
  return out;
}

// A plate of 6 cm in the middle of the image that faces the camera.
PosedModel Plate(PosedModel::Verdict verdict) {
  OrientedCloud cloud;
  for (int x = -10; x <= 10; ++x) {
    for (int y = -10; y <= 10; ++y) {
      cloud.points.emplace_back(0.003F * static_cast<float>(x), 0.003F * static_cast<float>(y), 0);
      cloud.normals.emplace_back(0, 0, -1);
    }
  }
  PosedModel out{.model = std::make_shared<SurfaceModel>(std::move(cloud), 1), .verdict = verdict};
  out.sensor_object.translation().z() = static_cast<double>(kPlateM);
  return out;
}

class FramePictureTest : public ::testing::Test {
 protected:
  FramePictureTest() { result_.frame = &frame_; }

  RealFrame frame_{.name = "wall", .path = {}, .sensor = "", .arrangement = "", .objects = {}};
  FrameResult result_;
};

TEST_F(FramePictureTest, HasNoBlackPixelForAScanWithoutHoles) {
  const pictures::ShadedPicture picture = DrawFrame(result_, Wall());
  EXPECT_EQ(std::ranges::count(picture.brightness, 0), 0);
}

TEST_F(FramePictureTest, IgnoresStrayAndMissingPointsInTheCrop) {
  Points scan = Wall();
  scan.emplace_back(0, -50, 0.01F);
  scan.emplace_back(1e30F, 0, 1e-30F);
  scan.emplace_back(0, 0, -1);
  scan.emplace_back(0, 0, 0);
  scan.emplace_back(Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
  const pictures::ShadedPicture picture = DrawFrame(result_, scan);
  EXPECT_EQ(std::ranges::count(picture.brightness, 0), 0);
}

TEST_F(FramePictureTest, IsBlackWithoutAMeasurement) {
  const pictures::ShadedPicture picture = DrawFrame(result_, {});
  EXPECT_THAT(picture.brightness, Each(0));
}

TEST_F(FramePictureTest, DrawsAModelAtItsPoseInTheColorOfItsVerdict) {
  result_.posed = {Plate(PosedModel::Verdict::kWrong)};
  const pictures::ShadedPicture picture = DrawFrame(result_, Wall());
  ASSERT_FALSE(picture.marks.empty());
  EXPECT_THAT(picture.marks, Each(Field(&pictures::ColoredPixel::rgb, 0xff4040U)));
  // 3 cm at 0.8 m are 18.75 of 320 pixels to each side of the middle.
  const double half = 0.03 / 0.8 * 500 / 320 * picture.width / 2 + 1;
  for (const pictures::ColoredPixel& mark : picture.marks) {
    const auto width = static_cast<std::size_t>(picture.width);
    const std::size_t row = mark.pixel / width;
    const auto x = static_cast<double>(mark.pixel % width);
    const auto y = static_cast<double>(row);
    EXPECT_NEAR(x, picture.width / 2.0, half);
    EXPECT_NEAR(y, picture.height / 2.0, half);
  }
}

TEST_F(FramePictureTest, ClipsModelsOutsideTheImage) {
  result_.posed = {Plate(PosedModel::Verdict::kRight)};
  result_.posed.front().sensor_object.translation().x() = 10;
  EXPECT_TRUE(DrawFrame(result_, Wall()).marks.empty());
}

}  // namespace
}  // namespace graspdb::lab
