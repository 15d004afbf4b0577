// Files as other programs write them: PCL's own writers, old headers, other fields.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pcl/io/pcd_io.h>
#include <pcl/point_types.h>

#include <random>
#include <string>

#include "files/points/point_file.h"
#include "tests/files/temporary_folder.h"

namespace graspdb::files {
namespace {

pcl::PointCloud<pcl::PointXYZRGBNormal> Coloured() {
  pcl::PointCloud<pcl::PointXYZRGBNormal> cloud(4, 3);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const auto f = static_cast<float>(i);
    cloud[i].getVector3fMap() = Eigen::Vector3f(0.1F * f, 1 + f, -f);
    cloud[i].getNormalVector3fMap() = Eigen::Vector3f(0, 1, 0.25F * f);
    cloud[i].rgba = 0xff00ff;
  }
  cloud[5].x = std::nanf("");
  cloud.sensor_origin_ = Eigen::Vector4f(0.5F, 0, 2, 0);
  cloud.sensor_orientation_ = Eigen::Quaternionf(0, 1, 0, 0);
  return cloud;
}

void ExpectColoured(const absl::StatusOr<PointFile>& read) {
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->width, 4);
  EXPECT_EQ(read->height, 3);
  ASSERT_EQ(read->points.size(), 12U);
  EXPECT_NEAR(read->points[3].x(), 0.3F, 1e-6);
  EXPECT_EQ(read->points[11].y(), 12);
  EXPECT_TRUE(read->points[0].isApprox(Eigen::Vector3f(0, 1, 0)));
  EXPECT_TRUE(read->points[5].array().isNaN().all()) << "all three when one is missing";
  ASSERT_EQ(read->normals.size(), 12U);
  EXPECT_EQ(read->normals[4], Eigen::Vector3f(0, 1, 1));
  ASSERT_TRUE(read->sensor_pose.has_value());
  EXPECT_TRUE(read->sensor_pose->translation().isApprox(Eigen::Vector3d(0.5, 0, 2)));
  EXPECT_TRUE(
      (read->sensor_pose->linear() * Eigen::Vector3d::UnitZ()).isApprox(-Eigen::Vector3d::UnitZ()));
}

TEST(PcdInterchange, PclAscii) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "cloud.pcd";
  ASSERT_EQ(pcl::io::savePCDFileASCII(path.string(), Coloured()), 0);
  ExpectColoured(ReadPointFile(path));
}

TEST(PcdInterchange, PclBinaryWithPadding) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "cloud.PCD";
  ASSERT_EQ(pcl::io::savePCDFileBinary(path.string(), Coloured()), 0);
  ExpectColoured(ReadPointFile(path));
}

TEST(PcdInterchange, PclBinaryCompressed) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "cloud.pcd";
  ASSERT_EQ(pcl::io::savePCDFileBinaryCompressed(path.string(), Coloured()), 0);
  ExpectColoured(ReadPointFile(path));
}

TEST(PcdInterchange, PclReadsOurs) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "cloud.pcd";
  PointFile file;
  file.width = 2;
  file.height = 2;
  file.points = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {10, 11, 12}};
  file.sensor_pose = recognition::Pose(Eigen::Translation3d(0, 0, 1));
  ASSERT_TRUE(WritePcd(path, file).ok());
  pcl::PointCloud<pcl::PointXYZ> cloud;
  ASSERT_EQ(pcl::io::loadPCDFile(path.string(), cloud), 0);
  EXPECT_EQ(cloud.width, 2U);
  EXPECT_EQ(cloud.height, 2U);
  EXPECT_EQ(cloud[2].getVector3fMap(), file.points[2]);
  EXPECT_EQ(cloud.sensor_origin_.z(), 1);
}

TEST(PcdInterchange, PclReadsOurNormals) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "cloud.pcd";
  const PointFile file = {.points = {{1, 2, 3}, {4, 5, 6}},
                          .normals = {{0, 0, 1}, {0, 0.6F, 0.8F}},
                          .width = 2,
                          .height = 1,
                          .sensor_pose = {}};
  ASSERT_TRUE(WritePcd(path, file).ok());
  pcl::PCLPointCloud2 blob;
  ASSERT_EQ(pcl::io::loadPCDFile(path.string(), blob), 0);
  pcl::PointCloud<pcl::PointNormal> cloud;
  pcl::fromPCLPointCloud2(blob, cloud);
  ASSERT_EQ(cloud.size(), 2U);
  EXPECT_EQ(cloud[1].getVector3fMap(), file.points[1]);
  EXPECT_EQ(cloud[1].getNormalVector3fMap(), file.normals[1]);
}

// Noise does not compress.
TEST(PcdInterchange, PclReadsOurNoise) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "cloud.pcd";
  PointFile file;
  file.width = 1000;
  file.height = 1;
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(-1, 1);
  for (int i = 0; i < file.width; ++i) {
    const float x = uniform(random);
    const float y = uniform(random);
    file.points.emplace_back(x, y, uniform(random));
  }
  ASSERT_TRUE(WritePcd(path, file).ok());
  pcl::PointCloud<pcl::PointXYZ> cloud;
  ASSERT_EQ(pcl::io::loadPCDFile(path.string(), cloud), 0);
  ASSERT_EQ(cloud.size(), file.points.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    EXPECT_EQ(cloud[i].getVector3fMap(), file.points[i]);
  }
}

TEST(PcdInterchange, DoublesOldHeaderWindowsLineEndsAndBlankLines) {
  const TemporaryFolder folder;
  const auto read = ReadPointFile(folder.Write(
      "cloud.pcd",
      "VERSION .5\r\nFIELDS label x y z\r\nSIZE 2 8 8 8\r\nTYPE U F F F\r\nWIDTH 2\r\nHEIGHT 1\r\n"
      "POINTS 2\r\nDATA ascii\r\n7 0.125 -2.5e-1 1\r\n\r\n8 nan nan nan\r\n"));
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->points[0], Eigen::Vector3f(0.125F, -0.25F, 1));
  EXPECT_TRUE(read->points[1].array().isNaN().all());
  EXPECT_FALSE(read->sensor_pose.has_value());
}

TEST(PcdInterchange, BinaryDoublesAndTheThreeWaysOfNoMeasurement) {
  const TemporaryFolder folder;
  std::string bytes =
      "FIELDS z y x\nSIZE 8 8 8\nTYPE F F F\nWIDTH 4\nHEIGHT 1\nPOINTS 4\nDATA binary\n";
  const double rows[4][3] = {{0.7, 0.2, 0.1}, {0, 0, 0}, {INFINITY, 1, 1}, {1e300, 1, 1}};
  bytes.append(reinterpret_cast<const char*>(rows), sizeof(rows));
  const auto read = ReadPointFile(folder.Write("cloud.pcd", bytes));
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->points[0], Eigen::Vector3f(0.1F, 0.2F, 0.7F));
  for (std::size_t i = 1; i < 4; ++i) EXPECT_TRUE(read->points[i].array().isNaN().all()) << i;
}

}  // namespace
}  // namespace graspdb::files
