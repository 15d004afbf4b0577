#include "rendering/meshes/mesh_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "rendering/meshes/solid.h"
#include "tests/files/temporary_folder.h"
#include "tests/rendering/mesh_measure.h"

namespace graspdb::rendering {
namespace {

using testing::HasSubstr;

// A triangle of (0, 0, 0), (1, 0, 0), (0, 1, 0), whose body begins with `first_byte`.
std::string TrianglePly(bool big_endian, const std::string& line_end, char first_byte) {
  std::string bytes;
  for (const std::string line :
       {"ply", big_endian ? "format binary_big_endian 1.0" : "format binary_little_endian 1.0",
        "element vertex 3", "property uchar red", "property float x", "property float y",
        "property float z", "element face 1", "property list uchar int vertex_indices",
        "end_header"}) {
    absl::StrAppend(&bytes, line, line_end);
  }
  const auto append = [&](std::uint32_t word) {
    for (int k = 0; k < 4; ++k) {
      bytes.push_back(static_cast<char>(word >> 8 * (big_endian ? 3 - k : k)));
    }
  };
  for (const Eigen::Vector3f& v : {Eigen::Vector3f::Zero().eval(), Eigen::Vector3f::UnitX().eval(),
                                   Eigen::Vector3f::UnitY().eval()}) {
    bytes.push_back(first_byte);
    for (const float c : {v.x(), v.y(), v.z()}) append(std::bit_cast<std::uint32_t>(c));
  }
  bytes.push_back(3);
  for (const std::uint32_t i : {0U, 1U, 2U}) append(i);
  return bytes;
}

// Three vertices and a face, which is a line of text.
std::string FacePly(const std::string& face) {
  return absl::StrCat(
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n",
      face, "\n");
}

TEST(MeshFile, PlyRoundTrip) {
  const files::TemporaryFolder folder;
  const TriangleMesh box = BoxSolid({0, 0, 0}, {0.1F, 0.2F, 0.3F});
  const auto path = folder.path() / "models" / "box.ply";
  ASSERT_TRUE(WriteMeshPly(path, box).ok());
  const auto loaded = LoadMesh(path);
  ASSERT_TRUE(loaded.ok()) << loaded.status();
  EXPECT_EQ(loaded->vertices.size(), 8U);
  EXPECT_EQ(loaded->triangles.size(), 12U);
  EXPECT_TRUE(IsClosed(*loaded));
  EXPECT_NEAR(VolumeOf(*loaded), 0.006, 1e-8);
}

// A first byte equal to a line end is not part of the header.
TEST(MeshFile, ReadsPlyBodiesThatBeginWithAnyByte) {
  const files::TemporaryFolder folder;
  TriangleMesh box = BoxSolid({0, 0, 0}, {0.1F, 0.2F, 0.3F});
  for (std::uint32_t first_byte = 0; first_byte < 256; ++first_byte) {
    box.vertices[0].x() = std::bit_cast<float>(0x3C000000U | first_byte);  // 7.8 mm
    const auto path = folder.path() / absl::StrCat("box", first_byte, ".ply");
    ASSERT_TRUE(WriteMeshPly(path, box).ok());
    const auto loaded = LoadMesh(path);
    ASSERT_TRUE(loaded.ok()) << first_byte << ": " << loaded.status();
    EXPECT_TRUE(loaded->vertices == box.vertices) << first_byte;
    EXPECT_TRUE(loaded->triangles == box.triangles) << first_byte;
  }
}

TEST(MeshFile, ReadsPlyBodiesThatBeginWithALineEndInEveryEncoding) {
  const files::TemporaryFolder folder;
  for (const bool big_endian : {false, true}) {
    for (const std::string line_end : {"\n", "\r\n"}) {
      for (const char first_byte : {'\n', '\r', '\t', ' ', '\0', 'x'}) {
        const auto path = folder.Write("a.ply", TrianglePly(big_endian, line_end, first_byte));
        SCOPED_TRACE(absl::CHexEscape(files::BytesOf(path)));
        const auto loaded = LoadMesh(path);
        ASSERT_TRUE(loaded.ok()) << loaded.status();
        EXPECT_EQ(loaded->triangles, (std::vector<std::array<int, 3>>{{0, 1, 2}}));
        ASSERT_EQ(loaded->vertices.size(), 3U);
        EXPECT_EQ(loaded->vertices[1], Eigen::Vector3f::UnitX());
        EXPECT_EQ(loaded->vertices[2], Eigen::Vector3f::UnitY());
      }
    }
  }
}

// As of a part that was mirrored in a CAD program.
TEST(MeshFile, AClosedSurfaceThatTurnsInwardsIsTurned) {
  const files::TemporaryFolder folder;
  const TriangleMesh box = BoxSolid({0, 0, 0}, {0.1F, 0.2F, 0.3F});
  TriangleMesh inwards = box;
  for (std::array<int, 3>& triangle : inwards.triangles) std::swap(triangle[0], triangle[1]);
  const auto path = folder.path() / "box.ply";
  ASSERT_TRUE(WriteMeshPly(path, inwards).ok());
  auto loaded = LoadMesh(path);
  ASSERT_TRUE(loaded.ok()) << loaded.status();
  EXPECT_TRUE(IsClosed(*loaded));
  EXPECT_NEAR(VolumeOf(*loaded), 0.006, 1e-8);

  inwards.triangles.pop_back();  // open: what is outside is unknown
  ASSERT_TRUE(WriteMeshPly(path, inwards).ok());
  loaded = LoadMesh(path);
  ASSERT_TRUE(loaded.ok()) << loaded.status();
  EXPECT_TRUE(loaded->triangles == inwards.triangles);
}

// Facets of an STL file share no vertices; joined they are a closed surface again.
TEST(MeshFile, JoinsStlFacetsAndScalesUnits) {
  const files::TemporaryFolder folder;
  const TriangleMesh box = BoxSolid({0, 0, 0}, {10, 20, 30});
  std::string text = "solid box\n";
  for (const auto& triangle : box.triangles) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const int i : triangle) {
      const Eigen::Vector3f& v = box.vertices[static_cast<std::size_t>(i)];
      text += "vertex " + std::to_string(v.x()) + " " + std::to_string(v.y()) + " " +
              std::to_string(v.z()) + "\n";
    }
    text += "endloop\nendfacet\n";
  }
  const auto loaded = LoadMesh(folder.Write("box.stl", text + "endsolid box\n"), 0.001);
  ASSERT_TRUE(loaded.ok()) << loaded.status();
  EXPECT_EQ(loaded->vertices.size(), 8U);
  EXPECT_TRUE(IsClosed(*loaded));
  EXPECT_NEAR(DiameterOf(*loaded), 0.001 * std::sqrt(1400.0), 1e-6);
}

TEST(MeshFile, SplitsObjPolygons) {
  const files::TemporaryFolder folder;
  const auto loaded = LoadMesh(folder.Write("two.obj",
                                            "o a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"
                                            "o b\nv 0 0 2\nv 1 0 2\nv 0 1 2\nf 5 6 7\n"));
  ASSERT_TRUE(loaded.ok()) << loaded.status();
  EXPECT_EQ(loaded->triangles.size(), 3U);
  EXPECT_EQ(BoundsOf(*loaded).max, Eigen::Vector3d(1, 1, 2));
}

TEST(MeshFile, RejectsOtherFilesWithThePath) {
  const files::TemporaryFolder folder;
  EXPECT_EQ(LoadMesh(folder.path() / "none.ply").status().code(), absl::StatusCode::kNotFound);
  const TriangleMesh box = BoxSolid({0, 0, 0}, {1, 1, 1});
  ASSERT_TRUE(WriteMeshPly(folder.path() / "box.ply", box).ok());
  const std::string whole = files::BytesOf(folder.path() / "box.ply");
  const std::filesystem::path bad[] = {
      folder.path(),
      folder.Write("empty.ply", ""),
      folder.Write("cornerless.ply", FacePly("0")),
      folder.Write("beyond.ply", FacePly("3 0 1 9")),
      folder.Write("text.stl", "Dear diary"),
      folder.Write("unknown.xyzzy", "1 2 3"),
      folder.Write("short.ply", whole.substr(0, whole.size() - 20)),
      folder.Write("header.ply", whole.substr(0, 90)),
      folder.Write("disguised.stl", whole.substr(0, 90)),
      folder.Write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"),
      folder.Write("nan.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")};
  for (const std::filesystem::path& path : bad) {
    const auto loaded = LoadMesh(path);
    EXPECT_EQ(loaded.status().code(), absl::StatusCode::kInvalidArgument) << path;
    EXPECT_THAT(std::string(loaded.status().message()), HasSubstr(path.string()));
    EXPECT_THAT(std::string(loaded.status().message()), ::testing::Not(HasSubstr(".;"))) << path;
  }
  EXPECT_EQ(LoadMesh(folder.path() / "box.ply", 0).status().code(),
            absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(WriteMeshPly(folder.path() / "no.ply", TriangleMesh{}).code(),
            absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace graspdb::rendering
