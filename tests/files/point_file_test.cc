#include "files/points/point_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "tests/files/temporary_folder.h"

namespace graspdb::files {
namespace {

using ::testing::HasSubstr;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

PointFile ThreeByTwo() {
  PointFile file;
  file.width = 3;
  file.height = 2;
  for (int i = 0; i < 6; ++i) {
    const auto f = static_cast<float>(i);
    file.points.emplace_back(0.01F * f, -0.1F + f / 3, 0.7F);
  }
  file.points[4].setConstant(kNaN);
  return file;
}

void ExpectSamePoints(const recognition::Points& a, const recognition::Points& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (b[i].allFinite()) {
      EXPECT_EQ(a[i], b[i]) << i;
    } else {
      EXPECT_TRUE(a[i].array().isNaN().all()) << i;
    }
  }
}

TEST(PointFile, RoundTripKeepsOrderNormalsAndSensorPose) {
  const TemporaryFolder folder;
  PointFile file = ThreeByTwo();
  file.normals.assign(6, Eigen::Vector3f(0, 0.6F, -0.8F));
  recognition::Pose pose(Eigen::AngleAxisd(2.5, Eigen::Vector3d(1, 2, 3).normalized()));
  pose.translation() = Eigen::Vector3d(0.123456, -1, 0.87654);
  file.sensor_pose = pose;
  const auto path = folder.path() / "cloud.pcd";
  ASSERT_TRUE(WritePcd(path, file).ok());
  const auto read = ReadPointFile(path);
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->width, 3);
  EXPECT_EQ(read->height, 2);
  ExpectSamePoints(read->points, file.points);
  EXPECT_EQ(read->normals, file.normals);
  ASSERT_TRUE(read->sensor_pose.has_value());
  EXPECT_TRUE(read->sensor_pose->isApprox(pose, 1e-5));
}

TEST(PointFile, NoSensorPoseStaysUnknownAndSameFileGivesSameBytes) {
  const TemporaryFolder folder;
  ASSERT_TRUE(WritePcd(folder.path() / "a.pcd", ThreeByTwo()).ok());
  ASSERT_TRUE(WritePcd(folder.path() / "b.pcd", ThreeByTwo()).ok());
  EXPECT_EQ(BytesOf(folder.path() / "a.pcd"), BytesOf(folder.path() / "b.pcd"));
  const auto read = ReadPointFile(folder.path() / "a.pcd");
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_FALSE(read->sensor_pose.has_value());
  EXPECT_TRUE(read->normals.empty());
  ASSERT_TRUE(WritePcd(folder.path() / "again.pcd", *read).ok());
  EXPECT_EQ(BytesOf(folder.path() / "again.pcd"), BytesOf(folder.path() / "a.pcd"));
}

TEST(PointFile, InconsistentFilesAreNotWritten) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "cloud.pcd";
  PointFile file = ThreeByTwo();
  file.width = 4;
  EXPECT_EQ(WritePcd(path, file).code(), absl::StatusCode::kInvalidArgument);
  file = ThreeByTwo();
  file.normals.resize(5);
  EXPECT_EQ(WritePcd(path, file).code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(WritePcd(path, PointFile{}).code(), absl::StatusCode::kInvalidArgument);
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(PointFile, OtherFilesAreRejectedWithPathAndAdvice) {
  const TemporaryFolder folder;
  const auto missing = ReadPointFile(folder.path() / "nowhere.pcd");
  EXPECT_EQ(missing.status().code(), absl::StatusCode::kNotFound);
  EXPECT_THAT(std::string(missing.status().message()), HasSubstr("nowhere.pcd does not exist"));

  std::filesystem::create_directories(folder.path() / "folder.pcd");
  const std::pair<std::filesystem::path, const char*> wrong[] = {
      {folder.path() / "folder.pcd", "is a folder"},
      {folder.Write("empty.pcd", ""), "is empty"},
      {folder.Write("empty.ply", ""), "is empty"},
      {folder.Write("cloud.xyz", "1 2 3\n"), "ends neither in .pcd nor in .ply"},
      {folder.Write("cloud", "1 2 3\n"), "ends neither in .pcd nor in .ply"}};
  for (const auto& [path, what] : wrong) {
    const auto read = ReadPointFile(path);
    EXPECT_EQ(read.status().code(), absl::StatusCode::kInvalidArgument) << path;
    EXPECT_THAT(std::string(read.status().message()), HasSubstr(path.string())) << path;
    EXPECT_THAT(std::string(read.status().message()), HasSubstr(what)) << path;
  }
}

}  // namespace
}  // namespace graspdb::files
