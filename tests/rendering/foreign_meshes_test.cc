// Meshes as other programs write them: read as they are meant, or an error.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <iterator>
#include <random>
#include <string>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "rendering/meshes/mesh_file.h"
#include "rendering/meshes/solid.h"
#include "tests/files/temporary_folder.h"
#include "tests/rendering/mesh_measure.h"

namespace graspdb::rendering {
namespace {

using ::testing::HasSubstr;

const TriangleMesh& Part() {
  static const TriangleMesh box = BoxSolid({0, 0, 0}, {0.1F, 0.2F, 0.3F});
  return box;
}

std::string Text(const Eigen::Vector3f& v) { return absl::StrCat(v.x(), " ", v.y(), " ", v.z()); }

std::string ObjVertices() {
  std::string text;
  for (const Eigen::Vector3f& v : Part().vertices) absl::StrAppend(&text, "v ", Text(v), "\n");
  return text;
}

std::string ObjFaces() {
  std::string text;
  for (const auto& [a, b, c] : Part().triangles) {
    absl::StrAppend(&text, "f ", a + 1, " ", b + 1, " ", c + 1, "\n");
  }
  return text;
}

std::string StlText() {
  std::string text = "solid part\n";
  for (const auto& triangle : Part().triangles) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const int i : triangle) {
      absl::StrAppend(&text, "vertex ", Text(Part().vertices[static_cast<std::size_t>(i)]), "\n");
    }
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid part\n";
}

std::string PlyText() {
  std::string text = absl::StrCat(
      "ply\nformat ascii 1.0\nelement vertex ", Part().vertices.size(),
      "\nproperty float x\nproperty float y\nproperty float z\nelement face ",
      Part().triangles.size(), "\nproperty list uchar int vertex_indices\nend_header\n");
  for (const Eigen::Vector3f& v : Part().vertices) absl::StrAppend(&text, Text(v), "\n");
  for (const auto& [a, b, c] : Part().triangles) {
    absl::StrAppend(&text, "3 ", a, " ", b, " ", c, "\n");
  }
  return text;
}

std::string Changed(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

void ExpectPart(const std::string& name, const std::string& bytes, double unit_m = 1) {
  SCOPED_TRACE(bytes.substr(0, 300));
  const files::TemporaryFolder folder;
  const auto mesh = LoadMesh(folder.Write(name, bytes), unit_m);
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_EQ(mesh->vertices.size(), 8U);
  EXPECT_EQ(mesh->triangles.size(), 12U);
  EXPECT_TRUE(IsClosed(*mesh));
  EXPECT_NEAR(VolumeOf(*mesh), 0.006 * unit_m * unit_m * unit_m, 1e-8);
  EXPECT_TRUE(BoundsOf(*mesh).min.isZero());
}

void ExpectRefusedMesh(const std::string& name, const std::string& bytes, const std::string& what,
                       double unit_m = 1) {
  const files::TemporaryFolder folder;
  const auto path = folder.Write(name, bytes);
  const auto mesh = LoadMesh(path, unit_m);
  ASSERT_EQ(mesh.status().code(), absl::StatusCode::kInvalidArgument) << what;
  EXPECT_THAT(std::string(mesh.status().message()), HasSubstr(path.string()));
  EXPECT_THAT(std::string(mesh.status().message()), HasSubstr(what));
}

TEST(ForeignMeshes, OnlyPlyObjAndStlAreRead) {
  ExpectRefusedMesh("a.dae", "<COLLADA/>", "Collada");
  ExpectRefusedMesh("a.gltf", "{}", "glTF");
  ExpectRefusedMesh("a.GLB", "glTF", "glTF");
  ExpectRefusedMesh("a.3mf", "PK", "3MF");
  ExpectRefusedMesh("a.fbx", "Kaydara", "FBX");
  ExpectRefusedMesh("a.off", "OFF", "OFF");
  ExpectRefusedMesh("a.xyz", "1 2 3", "export it as PLY, OBJ or STL");
  ExpectPart("A.PLY", PlyText());
  ExpectPart("A.OBJ", ObjVertices() + ObjFaces());
  ExpectPart("A.STL", StlText());
}

TEST(ForeignMeshes, AByteOrderMarkIsSkipped) {
  const std::string mark = "\xEF\xBB\xBF";
  ExpectPart("a.ply", mark + PlyText());
  ExpectPart("a.obj", mark + ObjVertices() + ObjFaces());
  ExpectPart("a.stl", mark + StlText());
  ExpectRefusedMesh("a.obj", std::string("\xFF\xFEv\0 \0", 6), "encoding UTF-16");
  ExpectRefusedMesh("a.stl", std::string("s\0o\0l\0", 6), "encoding UTF-16");
}

TEST(ForeignMeshes, NamesOfObjFilesContinueNoLine) {
  const std::string vertices = ObjVertices();
  const std::string faces = ObjFaces();
  ExpectPart("a.obj", "# saved as C:\\parts\\\n" + vertices + faces);
  ExpectPart("a.obj", vertices + "# faces of C:\\parts\\\r\n" + faces);
  ExpectPart("a.obj", "mtllib C:\\parts\\\n" + vertices + "usemtl grey\\\n" + faces);
  ExpectPart("a.obj", vertices + "g body\\\n" + faces);
  ExpectPart("a.obj", "o a\\\n" + vertices + "s off\n" + faces);
}

TEST(ForeignMeshes, FacesAndVerticesOfObjFilesMayBeContinued) {
  const std::string faces = Changed(ObjFaces(), "f 1 ", "f 1 \\\n ");
  ASSERT_THAT(faces, HasSubstr("\\\n"));
  ExpectPart("a.obj", ObjVertices() + faces);
  ExpectPart("a.obj", Changed(ObjVertices(), "v 0 ", "v 0 \\\r\n") + ObjFaces());
  ExpectRefusedMesh("a.obj", ObjVertices() + "f 1 2\n 3\n", "line 9 has a face with fewer");
  ExpectRefusedMesh("a.obj", ObjVertices() + "f 1 2 4\n 3\n",
                    "line 10 begins with \"3\", and the line before does not continue");
}

TEST(ForeignMeshes, CornersOfObjFilesAreCountedFromEitherEnd) {
  std::string faces;
  for (const auto& [a, b, c] : Part().triangles) {
    absl::StrAppend(&faces, "f ", a - 8, "//-1 ", b + 1, "/1/1 ", c - 8, "/2\n");
  }
  ExpectPart("a.obj", ObjVertices() + "vt 0 0\nvn 0 0 1\n" + faces);
  ExpectRefusedMesh("a.obj", ObjVertices() + "f 1 2 9\n", "line 9 has a face with the corner 9");
  ExpectRefusedMesh("a.obj", ObjVertices() + "f 1 2 0\n",
                    "line 9 has a face with the corner \"0\"");
  ExpectRefusedMesh("a.obj", ObjVertices() + "f 1 2 -9\n", "the corner \"-9\"");
  ExpectRefusedMesh("a.obj", "v 0,1 2 3\n", "line 1 has \"0,1\" where a finite number belongs");
  ExpectRefusedMesh("a.obj", "v 0 1\n", "line 1 has a vertex of 2 numbers");
  ExpectRefusedMesh("a.obj", ObjVertices() + "f 1,000 2 3\n", "the corner \"1,000\"");
  ExpectRefusedMesh("a.obj", ObjVertices() + "surf 0 1 0 1\n", "line 9 begins a curved surface");
}

// Each face counts back from its own place.
TEST(ForeignMeshes, VerticesOfObjFilesMayStandBetweenFaces) {
  std::string obj;
  for (const auto& triangle : Part().triangles) {
    for (const int i : triangle) {
      absl::StrAppend(&obj, "v ", Text(Part().vertices[static_cast<std::size_t>(i)]), "\n");
    }
    obj += "f -3 -2 -1\n";
  }
  ExpectPart("a.obj", obj);
}

TEST(ForeignMeshes, VerticesOfNoFaceDoNotCount) {
  ExpectPart("a.obj", "v 9 9 9\n" + ObjVertices() +
                          absl::StrReplaceAll(ObjFaces(), {{"8", "9"},
                                                           {"7", "8"},
                                                           {"6", "7"},
                                                           {"5", "6"},
                                                           {"4", "5"},
                                                           {"3", "4"},
                                                           {"2", "3"},
                                                           {"1", "2"}}));
  std::string ply = Changed(PlyText(), "element vertex 8", "element vertex 9");
  ExpectPart("a.ply", Changed(ply, "\n3 ", "\n9 9 9\n3 "));
}

TEST(ForeignMeshes, AsciiStlFiles) {
  const std::string text = StlText();
  const std::string upper = absl::AsciiStrToUpper(text);
  ExpectPart("a.stl", upper);
  ExpectPart("a.stl", absl::StrReplaceAll(text, {{"\n", "\r\n"}}));
  ExpectPart("a.stl", Changed(text, "solid part", "solid"));
  const std::size_t half = text.find("facet n", text.size() / 2);
  ExpectPart("a.stl",
             text.substr(0, half) + "endsolid part\nsolid second half\n" + text.substr(half));
  ExpectPart("a.stl", " \n" + text);
  ExpectPart("a.stl", Changed(text, "normal 0 0 0", "normal -1.#IND 1.#QNAN nan(ind)"));
  ExpectRefusedMesh("a.stl", Changed(text, "normal 0 0 0", "normal 0 0"),
                    "line 3 has \"loop\" where outer belongs");
  ExpectRefusedMesh("a.stl", text.substr(0, half), "cut short, as no endsolid");
  ExpectRefusedMesh("a.stl", text.substr(0, half + 30), "cut short within a facet");
  ExpectRefusedMesh("a.stl", Changed(text, "endloop", "vertex 1 1 1\nendloop"),
                    "line 7 has \"vertex\" where endloop belongs");
  ExpectRefusedMesh("a.stl", Changed(text, "vertex 0", "vertex 0,5"), "a finite number");
}

std::string StlBytes(const std::string& header) {
  std::string bytes = header + std::string(80 - header.size(), ' ');
  const auto append = [&bytes](const auto& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  append(static_cast<std::uint32_t>(Part().triangles.size()));
  for (const auto& triangle : Part().triangles) {
    bytes.append(12, '\0');
    for (const int i : triangle) append(Part().vertices[static_cast<std::size_t>(i)]);
    bytes.append(2, '\0');
  }
  return bytes;
}

TEST(ForeignMeshes, BinaryStlFilesAreKnownByTheirSize) {
  ExpectPart("a.stl", StlBytes("solid written by a program"));
  ExpectPart("a.stl", StlBytes(std::string("a\0\0\0", 4)));
  const std::string bytes = StlBytes("part");
  ExpectPart("a.stl", bytes);
  ExpectRefusedMesh("a.stl", bytes + "\n", "promises 684 bytes, and it has 685");
  ExpectRefusedMesh("a.stl", bytes.substr(0, 600), "promises 684 bytes, and it has 600");
}

TEST(ForeignMeshes, PlyFacesMustBeListsOfCorners) {
  ExpectPart("a.ply", Changed(PlyText(), "vertex_indices", "vertex_index"));
  ExpectRefusedMesh("a.ply", Changed(PlyText(), "element face", "element tristrips"),
                    "triangle strips");
  ExpectRefusedMesh("a.ply", Changed(PlyText(), "vertex_indices", "corners"),
                    "no list named vertex_indices");
  ExpectRefusedMesh("a.ply", Changed(PlyText(), "element face", "element facet"),
                    "no element named face");
  ExpectRefusedMesh("a.ply", PlyText() + "3 0 1 2\n", "a row beyond the elements");
  for (const char* length : {"ushort", "uint", "int", "uint16"}) {
    ExpectPart("a.ply", Changed(PlyText(), "list uchar", absl::StrCat("list ", length)));
  }
  ExpectRefusedMesh("a.ply", Changed(PlyText(), "\n3 ", "\n3\n"), "its 20 rows go over 21 lines");
  ExpectPart("a.ply", Changed(PlyText(), "\n3 ", "\n\n3 "));
  std::string other = Changed(PlyText(), "property list", "property uchar material\nproperty list");
  ExpectPart("a.ply", absl::StrReplaceAll(other, {{"\n3 ", "\n7 3 "}}));
}

TEST(ForeignMeshes, AStatedUnitMustBeTheGivenOne) {
  const std::string obj = ObjVertices() + ObjFaces();
  for (const char* comment :
       {"# units: mm", "# File units = Millimeters", "# 1 unit = 1 mm", "# Unit of length: mm",
        "# units in mm", "# units: mm, by a program", "# unit=millimetre",
        "# measured in units, where 1 unit = 1.000000 mm."}) {
    ExpectPart("a.obj", absl::StrCat(comment, "\n", obj), 0.001);
    ExpectRefusedMesh("a.obj", absl::StrCat(comment, "\n", obj), "states a unit of 0.001 m", 1);
  }
  for (const char* comment :
       {"# united parts", "# units: 25", "# unit", "# mm", "# unit vectors", "# units in use"}) {
    ExpectPart("a.obj", absl::StrCat(comment, "\n", obj), 1);
  }
  ExpectPart("a.obj", "# measured in units, where 1 unit = 1000.000000 mm\n" + obj, 1);
  ExpectRefusedMesh("a.stl", StlBytes("COLOR=abcd,UNITS=mm"), "states a unit of 0.001 m", 0.01);
  ExpectRefusedMesh("a.stl", Changed(StlText(), "part", "part units: inches"),
                    "states a unit of 0.0254 m, and it is read with a unit of 1 m");
  ExpectRefusedMesh("a.stl", StlBytes("unit = in, by a program"), "states a unit of 0.0254 m");
  for (const char* name : {"power-unit-in-housing", "Unit_M_12", "unit in", "unit mm"}) {
    ExpectPart("a.stl", StlBytes(name));
    ExpectPart("a.stl", Changed(StlText(), "part", name));
  }
  ExpectRefusedMesh("a.ply", Changed(PlyText(), "element", "comment unit: cm\nelement"),
                    "states a unit of 0.01 m");
  ExpectRefusedMesh("a.ply", Changed(PlyText(), "element", "obj_info units mm\nelement"),
                    "states a unit of 0.001 m");
}

TEST(ForeignMeshes, LinesAndFacesAreBounded) {
  const std::string obj = ObjVertices() + ObjFaces();
  ExpectPart("a.obj", "#" + std::string(300, ' ') + "units: mm\n" + obj);
  ExpectPart("a.obj",
             "#" + std::string(180, ' ') + "units: m " + std::string(99, '-') + "\n" + obj);
  ExpectPart("a.obj", "#" + std::string(1'000'000, ' ') + "\n" + obj);
  ExpectRefusedMesh("a.obj", "#" + std::string(1'100'000, '-') + "\n" + obj,
                    "line 1 is longer than 1 MiB");
  std::string continued = obj + "f 1 2 3";
  for (int i = 0; i < 20; ++i) continued += " 1" + std::string(60'000, ' ') + "1 \\\n";
  ExpectRefusedMesh("a.obj", continued + "1\n", "is longer than 1 MiB");
  std::string corners;
  for (int i = 0; i < 10'001; ++i) absl::StrAppend(&corners, " ", i % 8 + 1);
  ExpectRefusedMesh("a.obj", absl::StrCat(obj, "f", corners, "\n"), "a face has 10001 corners");
  corners = absl::StrReplaceAll(corners, {{"8", "0"}});
  std::string ply = Changed(PlyText(), "face 12", "face 13");
  ExpectRefusedMesh("a.ply",
                    absl::StrCat(Changed(ply, "list uchar", "list uint"), "10001", corners, "\n"),
                    "a face has 10001 corners");
}

TEST(ForeignMeshes, FlippedBytesNeverCrash) {
  const files::TemporaryFolder folder;
  std::mt19937 random(7);  // NOLINT: the same bytes every time
  const std::pair<std::string, std::string> files[] = {{"a.obj", ObjVertices() + ObjFaces()},
                                                       {"a.stl", StlText()},
                                                       {"a.stl", StlBytes("part")},
                                                       {"a.ply", PlyText()}};
  for (int round = 0; round < 1200; ++round) {
    auto [name, bytes] = files[static_cast<std::size_t>(round) % std::size(files)];
    for (int k = 0; k <= round % 3; ++k)
      bytes[random() % bytes.size()] = static_cast<char>(random());
    if (round % 5 == 0) bytes.resize(random() % bytes.size());
    const auto mesh = LoadMesh(folder.Write(name, bytes));
    EXPECT_TRUE(!mesh.ok() || CheckMesh(*mesh).ok());
  }
}

// In the coordinates of a plant, as from its CAD layout.
TEST(ForeignMeshes, MeshesFarFromTheirOriginAreErrors) {
  const auto moved = [](double by) {
    std::string text;
    for (const Eigen::Vector3f& v : Part().vertices) {
      const Eigen::Vector3d at = v.cast<double>() * 1000;
      absl::StrAppendFormat(&text, "v %.3f %.3f %.3f\n", at.x() + by, at.y(), at.z());
    }
    return text + ObjFaces();
  };
  const files::TemporaryFolder folder;
  EXPECT_TRUE(LoadMesh(folder.Write("near.obj", moved(5000)), 0.001).ok());
  ExpectRefusedMesh("far.obj", moved(1e6), "m away from its origin", 0.001);
}

}  // namespace
}  // namespace graspdb::rendering
