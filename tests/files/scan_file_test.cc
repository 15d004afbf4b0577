#include "files/scan_file.h"

#include <gmock/gmock.h>

#include "files/depth/depth_png.h"
#include "files/messages/scan_message.h"
#include "files/points/point_file.h"
#include "graspdb/v1/catalog.pb.h"
#include "tests/files/temporary_folder.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::files {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::StatusIs;

TEST(ReadScanFile, AnImageHasTheCameraBesideItAndTheCountsOfTheFile) {
  const TemporaryFolder folder;
  const DepthPngCamera camera = {
      .intrinsics = {.width = 2, .height = 1, .fx = 500, .fy = 500, .cx = 0.5, .cy = 0},
      .depth_unit_m = 0.0001};
  const v1::DepthImage written = DepthMessage({7, 0}, camera.intrinsics, camera.depth_unit_m);
  ASSERT_THAT(WriteDepthPng(folder.path() / "a.PNG", written), IsOk());
  EXPECT_THAT(ReadScanFile(folder.path() / "a.PNG"),
              StatusIs(absl::StatusCode::kNotFound, HasSubstr(kIntrinsicsFile)));
  ASSERT_THAT(WriteIntrinsics(folder.path() / kIntrinsicsFile, camera), IsOk());
  auto file = ReadScanFile(folder.path() / "a.PNG");
  ASSERT_THAT(file, IsOk());
  EXPECT_FALSE(file->sensor_pose);
  v1::View view;
  SetScan(std::move(file->scan), &view);
  EXPECT_FALSE(view.has_cloud());
  EXPECT_EQ(view.depth_image().SerializeAsString(), written.SerializeAsString());
}

TEST(ReadScanFile, AnImageOfADistortingLensIsTheCloudOfItsUndistortedPoints) {
  const TemporaryFolder folder;
  const v1::DepthImage image = DepthMessage({1000, 0, 1000}, {3, 1, 3, 3, 1, 0}, 0.001);
  ASSERT_THAT(WriteDepthPng(folder.path() / "a.png", image), IsOk());
  const auto read = [&](const std::string& lens) {
    folder.Write(kIntrinsicsFile,
                 R"({"width": 3, "height": 1, "fx": 3, "fy": 3, "cx": 1, "cy": 0, )" + lens + "}");
    return ReadScanFile(folder.path() / "a.png");
  };
  EXPECT_TRUE(std::holds_alternative<v1::DepthImage>(read(R"("D": [0, 0, 0, 0, 0])")->scan));
  const auto file = read(R"("model": "Inverse Brown Conrady", "coeffs": [0.9, 0, 0, 0, 0])");
  ASSERT_THAT(file, IsOk());
  const auto points = PointsFromMessage(std::get<v1::PointCloud>(file->scan));
  ASSERT_THAT(points, IsOk());
  ASSERT_EQ(points->size(), 2U);
  const double x = (*points)[1].x();  // as undistortPoints, in spite of the model's name
  EXPECT_NEAR(x * (1 + 0.9 * x * x), 1.0 / 3, 1e-6);
  EXPECT_EQ((*points)[1].z(), 1);
  EXPECT_THAT(read(R"("k1": -9)"),  // folds the image: nothing is shown as far out
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("coefficients")));
}

TEST(ReadScanFile, APointFileHasItsPointsAndItsSensorPose) {
  const TemporaryFolder folder;
  const PointFile points{.points = {{0, 0, 0.5F}},
                         .normals = {},
                         .width = 1,
                         .height = 1,
                         .sensor_pose = recognition::Pose(Eigen::Translation3d(0, 0, 0.5))};
  ASSERT_THAT(WritePcd(folder.path() / "a.pcd", points), IsOk());
  auto file = ReadScanFile(folder.path() / "a.pcd");
  ASSERT_THAT(file, IsOk());
  EXPECT_TRUE(file->sensor_pose);
  v1::View view;
  SetScan(std::move(file->scan), &view);
  EXPECT_FALSE(view.has_depth_image());
  EXPECT_EQ(view.cloud().data().size(), 12U);
}

TEST(ReadScanFile, OtherFilesAreErrors) {
  const TemporaryFolder folder;
  EXPECT_FALSE(IsScanFile("a.txt"));
  EXPECT_TRUE(IsScanFile("a.PLY"));
  EXPECT_THAT(ReadScanFile(folder.Write("a.txt", "text")),
              StatusIs(absl::StatusCode::kInvalidArgument));
  EXPECT_THAT(ReadScanFile(folder.path() / "none.pcd"), StatusIs(absl::StatusCode::kNotFound));
}

}  // namespace
}  // namespace graspdb::files
