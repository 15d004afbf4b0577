#include "files/points/ply_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>
#include <string>

#include "tests/files/temporary_folder.h"

namespace graspdb::files {
namespace {

using ::testing::HasSubstr;

constexpr char kMesh[] =
    "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 4\nproperty float x\n"
    "property float y\nproperty float z\nelement face 2\n"
    "property list uchar uint vertex_indices\nend_header\n"
    "0 0 1\n0 0 2\n0 1 0\nnan nan nan\n3 0 1 2\n4 3 2 1 0\n";

template <typename T>
void Append(std::string& bytes, T value, bool big_endian) {
  std::string raw(sizeof(T), '\0');
  std::memcpy(raw.data(), &value, sizeof(T));
  if (big_endian) std::reverse(raw.begin(), raw.end());
  bytes += raw;
}

// Two vertices with normals and a colour, and one face before them.
std::string Binary(bool big_endian) {
  std::string bytes = std::string("ply\nformat ") +
                      (big_endian ? "binary_big_endian" : "binary_little_endian") +
                      " 1.0\nelement face 1\nproperty list uchar int vertex_indices\n"
                      "element vertex 2\nproperty double x\nproperty double y\n"
                      "property double z\nproperty uchar red\nproperty float nx\n"
                      "property float ny\nproperty float nz\nend_header\n";
  Append<std::uint8_t>(bytes, 3, big_endian);
  for (const int index : {0, 1, 0}) Append<std::int32_t>(bytes, index, big_endian);
  for (const double at : {1.0, 2.0}) {
    for (int k = 0; k < 3; ++k) Append<double>(bytes, at + k, big_endian);
    Append<std::uint8_t>(bytes, 200, big_endian);
    for (int k = 0; k < 3; ++k) Append<float>(bytes, k == 2 ? 1.0F : 0.0F, big_endian);
  }
  return bytes;
}

TEST(PlyFile, AsciiMeshGivesItsVertices) {
  const TemporaryFolder folder;
  const auto read = ReadPointFile(folder.Write("mesh.ply", kMesh));
  ASSERT_TRUE(read.ok()) << read.status();
  ASSERT_EQ(read->points.size(), 4U);
  EXPECT_EQ(read->points[1], Eigen::Vector3f(0, 0, 2));
  EXPECT_TRUE(read->points[3].array().isNaN().all());
  EXPECT_EQ(read->width, 4);
  EXPECT_EQ(read->height, 1);
  EXPECT_TRUE(read->normals.empty());
  EXPECT_FALSE(read->sensor_pose.has_value());
}

TEST(PlyFile, BothByteOrdersWithNormalsAndFacesFirst) {
  const TemporaryFolder folder;
  for (const bool big_endian : {false, true}) {
    const auto read = ReadPointFile(folder.Write("cloud.PLY", Binary(big_endian)));
    ASSERT_TRUE(read.ok()) << read.status();
    ASSERT_EQ(read->points.size(), 2U);
    EXPECT_EQ(read->points[1], Eigen::Vector3f(2, 3, 4));
    ASSERT_EQ(read->normals.size(), 2U);
    EXPECT_EQ(read->normals[0], Eigen::Vector3f(0, 0, 1));
  }
}

void ExpectPlyRefused(const std::string& bytes, const std::string& what) {
  const TemporaryFolder folder;
  const auto path = folder.Write("cloud.ply", bytes);
  const auto read = ReadPointFile(path);
  ASSERT_EQ(read.status().code(), absl::StatusCode::kInvalidArgument) << what;
  EXPECT_THAT(std::string(read.status().message()), ::testing::StartsWith(path.string()));
  EXPECT_THAT(std::string(read.status().message()), HasSubstr(what));
}

std::string Changed(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

TEST(PlyFile, MalformedFilesGetOneSentence) {
  ExpectPlyRefused("# .PCD v0.7\nFIELDS x y z\n", "not a PLY file");
  ExpectPlyRefused("ply\nformat ascii 1.0\nelement vertex 3\n", "no end_header");
  ExpectPlyRefused(Changed(kMesh, "format ascii 1.0\n", ""), "no format line");
  ExpectPlyRefused(Changed(kMesh, "ascii", "utf8"), "format line names no encoding");
  ExpectPlyRefused(Changed(kMesh, "vertex 4", "vertex -4"), "element line");
  ExpectPlyRefused(Changed(kMesh, "vertex 4", "vertex 20000000"), "promises 20000000 points");
  ExpectPlyRefused(Changed(kMesh, "vertex 4", "vertex 0"), "has no points");
  ExpectPlyRefused(Changed(kMesh, "vertex 4", "point 4"), "no element named vertex");
  ExpectPlyRefused(Changed(kMesh, "element face 2", "element vertex 0\nelement face 2"),
                   "two elements named vertex");
  ExpectPlyRefused(Changed(kMesh, "float z", "float w"), "no x, y and z");
  ExpectPlyRefused(Changed(kMesh, "float z", "int z"), "no x, y and z");
  ExpectPlyRefused(Changed(kMesh, "float z", "quad z"), "type unknown to PLY");
  ExpectPlyRefused(Changed(kMesh, "float z", "list uchar float z"), "list property");
  ExpectPlyRefused(Changed(kMesh, "0 0 2", "0 zero 2"), "at point 2, \"zero\"");
  ExpectPlyRefused(Changed(kMesh, "4 3 2 1 0\n", "4 3 2 1"), "body ends");
  ExpectPlyRefused(Changed(kMesh, "4 3 2 1 0\n", "-4 3 2 1"),
                   "row 2 of its element face, a list has the length -4");
  for (const bool big_endian : {false, true}) {
    const std::string whole = Binary(big_endian);
    ExpectPlyRefused(whole.substr(0, whole.size() - 1), "at point 2, its body ends");
  }
}

// Rows with colours or normals that the header does not declare would be read as shifted points.
TEST(PlyFile, RowsOfOtherLengthsAreErrors) {
  ExpectPlyRefused(Changed(kMesh, "0 0 1\n", "0 0 1 120 130 140\n"),
                   "at point 1, its row has more or fewer numbers");
  ExpectPlyRefused(Changed(kMesh, "0 1 0\n", "0 1\n"),
                   "at point 3, its row has more or fewer numbers");
  ExpectPlyRefused(Changed(kMesh, "nan nan nan\n", "nan nan\n"),
                   "at point 4, its row has more or fewer numbers");
  ExpectPlyRefused(Changed(kMesh, "4 3 2 1 0\n", "4 3 2 1\n"),
                   "row 2 of its element face, its body ends");
  ExpectPlyRefused(Changed(kMesh, "3 0 1 2\n", "3 0 1 2 255\n"),
                   "row 1 of its element face, its row has more or fewer numbers");
  ExpectPlyRefused(Changed(kMesh, "3 0 1 2\n", "3.5 0 1 2\n"), "a list has the length 3.5");
  ExpectPlyRefused(std::string(kMesh) + "3 0 1 2\n", "line 17 has a row beyond the elements");
}

TEST(PlyFile, RowsOverSeveralLinesAreRead) {
  const TemporaryFolder folder;
  const auto read = ReadPointFile(
      folder.Write("cloud.ply",
                   "ply\nformat ascii 1.0\ncomment pointcloud saved from Realsense Viewer\n"
                   "element vertex 2\nproperty float32 x\nproperty float32 y\n"
                   "property float32 z\nproperty float32 nx\nproperty float32 ny\n"
                   "property float32 nz\nproperty uchar red\nproperty uchar green\n"
                   "property uchar blue\nend_header\n"
                   "0 1 2\n0 0 -1\n90 91 92\n3 4 5 \r\n0 1 0\n93 94 95\n"));
  ASSERT_TRUE(read.ok()) << read.status();
  ASSERT_EQ(read->points.size(), 2U);
  EXPECT_EQ(read->points[1], Eigen::Vector3f(3, 4, 5));
  ASSERT_EQ(read->normals.size(), 2U);
  EXPECT_EQ(read->normals[1], Eigen::Vector3f(0, 1, 0));
}

TEST(PlyFile, BlankLinesAndCarriageReturnsAreNoRows) {
  const TemporaryFolder folder;
  std::string text = std::string(kMesh) + "\n \n";
  text.insert(text.find("3 0 1 2"), "\n");
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2) {
    text.insert(at, 1, '\r');
  }
  const auto read = ReadPointFile(folder.Write("cloud.ply", text));
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->points.size(), 4U);
}

TEST(PlyFile, AByteOrderMarkIsSkipped) {
  const TemporaryFolder folder;
  for (const std::string& bytes : {std::string(kMesh), Binary(false)}) {
    const auto read = ReadPointFile(folder.Write("cloud.ply", "\xEF\xBB\xBF" + bytes));
    ASSERT_TRUE(read.ok()) << read.status();
    EXPECT_EQ(read->points.size(), bytes == kMesh ? 4U : 2U);
  }
  ExpectPlyRefused(std::string("\xFF\xFEp\0l\0y\0\n\0", 10), "has the encoding UTF-16");
}

// As earlier versions of PCL pad PCD files, up to a page.
TEST(PlyFile, BytesBehindABinaryBodyAreErrorsIfNotZeros) {
  const std::string whole = Binary(false);
  ExpectPlyRefused(whole + "\n", "and 1 more bytes follow");
  ExpectPlyRefused(whole + std::string(65536, '\0'), "and 65536 more bytes follow");
  const TemporaryFolder folder;
  const auto read = ReadPointFile(folder.Write("cloud.ply", whole + std::string(4000, '\0')));
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->points.size(), 2U);
}

TEST(PlyFile, FlippedBytesNeverCrash) {
  const TemporaryFolder folder;
  std::mt19937 random(7);  // NOLINT: the same bytes every time
  for (int round = 0; round < 2000; ++round) {
    std::string bytes = round % 2 == 0 ? Binary(round % 4 == 0) : std::string(kMesh);
    for (int k = 0; k <= round % 3; ++k)
      bytes[random() % bytes.size()] = static_cast<char>(random());
    const auto read = ReadPointFile(folder.Write("bad.ply", bytes));
    if (read.ok()) {
      EXPECT_EQ(static_cast<int>(read->points.size()), read->width);
    }
  }
}

}  // namespace
}  // namespace graspdb::files
