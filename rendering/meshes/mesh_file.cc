#include "rendering/meshes/mesh_file.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <cmath>
#include <exception>
#include <limits>
#include <span>
#include <string>
#include <system_error>

#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "files/base/atomic_file.h"
#include "rendering/meshes/mesh_content.h"
#include "rendering/meshes/outward_faces.h"

namespace graspdb::rendering {
namespace {

// Validated first, as assimp's own steps crash on indices that a truncated file
// leaves out of range. Vertices count as equal whatever their normals, colours and
// textures, so these are dropped; points and lines are dropped with them.
constexpr unsigned kImportSteps = aiProcess_ValidateDataStructure | aiProcess_RemoveComponent |
                                  aiProcess_Triangulate | aiProcess_SortByPType |
                                  aiProcess_JoinIdenticalVertices;
constexpr int kDropped = aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS |
                         aiComponent_COLORS | aiComponent_TEXCOORDS | aiComponent_MATERIALS;

absl::Status Bad(const std::filesystem::path& path, std::string what) {
  while (what.ends_with('.')) what.pop_back();  // assimp's sentences
  const char* advice = absl::StrContains(what, "; ") ? "" : "; export it again as PLY, OBJ or STL";
  return absl::InvalidArgumentError(
      absl::StrCat(path.string(), " is no usable mesh: ", what, advice));
}

void AppendMesh(const aiMesh& from, TriangleMesh& mesh) {
  const auto first = static_cast<int>(mesh.vertices.size());
  for (unsigned i = 0; i < from.mNumVertices; ++i) {
    const aiVector3D& v = from.mVertices[i];
    mesh.vertices.emplace_back(v.x, v.y, v.z);
  }
  for (unsigned i = 0; i < from.mNumFaces; ++i) {
    const aiFace& face = from.mFaces[i];
    if (face.mNumIndices != 3) continue;
    mesh.triangles.push_back({first + static_cast<int>(face.mIndices[0]),
                              first + static_cast<int>(face.mIndices[1]),
                              first + static_cast<int>(face.mIndices[2])});
  }
}

// In the three formats, whose nodes have no transforms, each mesh is once.
absl::StatusOr<TriangleMesh> AllMeshes(const aiScene& scene) {
  TriangleMesh mesh;
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    const aiMesh& from = *scene.mMeshes[m];
    if (mesh.vertices.size() + from.mNumVertices > std::numeric_limits<int>::max()) {
      return absl::InvalidArgumentError("it has too many vertices");
    }
    AppendMesh(from, mesh);
  }
  return mesh;
}

// assimp's time for a face grows with the square of its corners.
constexpr std::size_t kMaxCorners = 10'000;

// Checks preconditions of assimp's steps, which abort the process otherwise.
absl::Status CheckFaces(const aiScene& scene) {
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[m];
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      const std::span<const unsigned> corners(face.mIndices, face.mNumIndices);
      if (corners.empty()) return absl::InvalidArgumentError("a face has no corners");
      if (corners.size() > kMaxCorners) {
        return absl::InvalidArgumentError(absl::StrCat("a face has ", corners.size(),
                                                       " corners, and at most ", kMaxCorners,
                                                       " are read; export it with triangles"));
      }
      if (*std::ranges::max_element(corners) >= mesh.mNumVertices) {
        return absl::InvalidArgumentError("a face has a corner that is not a vertex");
      }
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<TriangleMesh> Import(const MeshContent& content) {
  try {
    Assimp::Importer importer;
    importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, kDropped);
    importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE,
                                aiPrimitiveType_POINT | aiPrimitiveType_LINE);
    const aiScene* scene = importer.ReadFileFromMemory(content.bytes.data(), content.bytes.size(),
                                                       0, content.format.c_str());
    if (scene != nullptr) {
      RETURN_IF_ERROR(CheckFaces(*scene));
      scene = importer.ApplyPostProcessing(kImportSteps);
    }
    if (scene == nullptr) return absl::InvalidArgumentError(importer.GetErrorString());
    return AllMeshes(*scene);
  } catch (const std::exception& e) {
    return absl::InvalidArgumentError(e.what());
  }
}

// Vertices of no triangle, which would count for the size of the part.
void RemoveUnusedVertices(TriangleMesh& mesh) {
  std::vector<int> moved(mesh.vertices.size(), -1);
  for (const std::array<int, 3>& triangle : mesh.triangles) {
    for (const int i : triangle) moved[static_cast<std::size_t>(i)] = 0;
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    if (moved[i] < 0) continue;
    mesh.vertices[kept] = mesh.vertices[i];
    moved[i] = static_cast<int>(kept++);
  }
  mesh.vertices.resize(kept);
  for (std::array<int, 3>& triangle : mesh.triangles) {
    for (int& i : triangle) i = moved[static_cast<std::size_t>(i)];
  }
}

// Steps of single precision at the farthest coordinate that the largest side must have.
constexpr double kMinSteps = 1e4;

absl::Status CheckPrecision(const TriangleMesh& mesh) {
  const recognition::Box box = BoundsOf(mesh);
  const double side = (box.max - box.min).maxCoeff();
  const double farthest = std::max(box.max.cwiseAbs().maxCoeff(), box.min.cwiseAbs().maxCoeff());
  const double step = farthest * static_cast<double>(std::numeric_limits<float>::epsilon());
  if (side >= kMinSteps * step) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(
      "it is ", side, " m large and ", farthest, " m away from its origin, where single ",
      "precision rounds to steps of ", step, " m; move it to its origin"));
}

absl::Status CheckUnit(const MeshContent& content, double unit_scale_m) {
  if (!content.unit_m || std::abs(*content.unit_m / unit_scale_m - 1) < 1e-6) {
    return absl::OkStatus();
  }
  const absl::string_view line = absl::string_view(content.unit_line).substr(0, 80);
  return absl::InvalidArgumentError(
      absl::StrCat("its line \"", absl::CHexEscape(line), "\" states a unit of ", *content.unit_m,
                   " m, and it is read with a unit of ", unit_scale_m,
                   " m; give the unit that is right, or correct or remove the line"));
}

template <typename T>
void AppendBytes(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

}  // namespace

absl::StatusOr<TriangleMesh> LoadMesh(const std::filesystem::path& path, double unit_scale_m) {
  if (!std::isfinite(unit_scale_m) || unit_scale_m <= 0) {
    return absl::InvalidArgumentError(
        absl::StrCat("the unit of ", path.string(), " is ", unit_scale_m, " m; give a length"));
  }
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    return absl::NotFoundError(
        absl::StrCat(path.string(), " does not exist; check the path of the mesh"));
  }
  if (!std::filesystem::is_regular_file(path, error)) return Bad(path, "it is not a file");
  const absl::StatusOr<MeshContent> content = ReadMeshContent(path);
  if (!content.ok()) return Bad(path, std::string(content.status().message()));
  if (absl::Status unit = CheckUnit(*content, unit_scale_m); !unit.ok()) {
    return Bad(path, std::string(unit.message()));
  }
  absl::StatusOr<TriangleMesh> mesh = Import(*content);
  if (!mesh.ok()) return Bad(path, std::string(mesh.status().message()));
  absl::Status checked = CheckMesh(*mesh);
  if (!checked.ok()) return Bad(path, std::string(checked.message()));
  RemoveUnusedVertices(*mesh);
  for (Eigen::Vector3f& v : mesh->vertices) v *= static_cast<float>(unit_scale_m);
  checked = CheckMesh(*mesh);  // of the scaled numbers
  if (checked.ok()) checked = CheckPrecision(*mesh);
  if (!checked.ok()) return Bad(path, std::string(checked.message()));
  RemoveRepeated(*mesh);
  TurnOutwards(*mesh);
  return mesh;
}

absl::Status WriteMeshPly(const std::filesystem::path& path, const TriangleMesh& mesh) {
  RETURN_IF_ERROR(CheckMesh(mesh));
  std::string bytes = absl::StrCat(
      "ply\nformat binary_little_endian 1.0\ncomment metres\nelement vertex ", mesh.vertices.size(),
      "\nproperty float x\nproperty float y\nproperty float z\nelement face ",
      mesh.triangles.size(), "\nproperty list uchar int vertex_indices\nend_header\n");
  for (const Eigen::Vector3f& v : mesh.vertices) {
    for (const float c : {v.x(), v.y(), v.z()}) AppendBytes(bytes, c);
  }
  for (const std::array<int, 3>& t : mesh.triangles) {
    bytes.push_back(3);
    for (const int i : t) AppendBytes(bytes, i);
  }
  return files::WriteFileAtomically(path, bytes, files::Durability::kProcessCrash);
}

}  // namespace graspdb::rendering
