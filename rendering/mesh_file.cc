#include "rendering/mesh_file.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <cmath>
#include <exception>
#include <fstream>
#include <iterator>
#include <limits>
#include <span>
#include <sstream>
#include <string>
#include <system_error>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "files/atomic_file.h"
#include "files/ply_file.h"
#include "files/ply_header.h"

namespace graspdb::client {
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
  return absl::InvalidArgumentError(absl::StrCat(path.string(), " is no usable mesh: ", what,
                                                 "; export it again as PLY, OBJ or STL"));
}

// False when the number of vertices exceeds an int.
bool AppendMesh(const aiMesh& from, const aiMatrix4x4& placed, TriangleMesh& mesh) {
  if (mesh.vertices.size() + from.mNumVertices > std::numeric_limits<int>::max()) return false;
  const auto first = static_cast<int>(mesh.vertices.size());
  for (unsigned i = 0; i < from.mNumVertices; ++i) {
    const aiVector3D v = placed * from.mVertices[i];
    mesh.vertices.emplace_back(v.x, v.y, v.z);
  }
  for (unsigned i = 0; i < from.mNumFaces; ++i) {
    const aiFace& face = from.mFaces[i];
    if (face.mNumIndices != 3) continue;
    mesh.triangles.push_back({first + static_cast<int>(face.mIndices[0]),
                              first + static_cast<int>(face.mIndices[1]),
                              first + static_cast<int>(face.mIndices[2])});
  }
  return true;
}

// Walks the nodes without recursion, since their depth is untrusted.
absl::Status AppendNodes(const aiScene& scene, TriangleMesh& mesh) {
  struct Placed {
    const aiNode* node;
    aiMatrix4x4 above;
  };
  std::vector<Placed> open = {{scene.mRootNode, aiMatrix4x4()}};
  while (!open.empty()) {
    const Placed next = open.back();
    open.pop_back();
    const aiMatrix4x4 placed = next.above * next.node->mTransformation;
    for (unsigned i = 0; i < next.node->mNumMeshes; ++i) {
      if (!AppendMesh(*scene.mMeshes[next.node->mMeshes[i]], placed, mesh)) {
        return absl::InvalidArgumentError("it has too many vertices");
      }
    }
    for (unsigned i = next.node->mNumChildren; i > 0; --i) {
      open.push_back({next.node->mChildren[i - 1], placed});
    }
  }
  return absl::OkStatus();
}

// Whether assimp may read it as a PLY file, by its content or its extension.
bool IsPly(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::string magic(3, '\0');
  in.read(magic.data(), std::ssize(magic));
  return absl::AsciiStrToLower(magic) == "ply" ||
         absl::AsciiStrToLower(path.extension().string()) == ".ply";
}

// assimp never returns from some damaged PLY files, so our own reader reads them first.
absl::Status CheckPly(const std::filesystem::path& path) {
  return IsPly(path) ? ReadPly(path).status() : absl::OkStatus();
}

// The content of a binary PLY file with an element of one letter before all others; empty for other
// files. assimp drops a body's first byte where it looks like one more line end of the header
// (github.com/assimp/assimp/issues/5341), and misreads all that follows. The element is named 1,
// since assimp reads the count of an unknown element at the position of its name.
std::string PaddedPly(const std::filesystem::path& path) {
  if (!IsPly(path)) return "";
  std::ifstream in(path, std::ios::binary);
  std::ostringstream content;
  content << in.rdbuf();
  std::string bytes = std::move(content).str();
  const absl::StatusOr<PlyHeader> header = ParsePlyHeader(bytes);
  if (!header.ok() || header->encoding == PlyHeader::Encoding::kAscii) return "";
  if (header->elements_offset == 0) return "";
  bytes.insert(header->body_offset, 1, 'x');
  bytes.insert(header->elements_offset, "element 1 1\nproperty uchar pad\n");
  return bytes;
}

// Checks preconditions of assimp's steps, which abort the process otherwise.
absl::Status CheckFaces(const aiScene& scene) {
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[m];
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      const std::span<const unsigned> corners(face.mIndices, face.mNumIndices);
      if (corners.empty()) return absl::InvalidArgumentError("a face has no corners");
      if (*std::ranges::max_element(corners) >= mesh.mNumVertices) {
        return absl::InvalidArgumentError("a face has a corner that is not a vertex");
      }
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<TriangleMesh> Import(const std::filesystem::path& path) {
  try {
    Assimp::Importer importer;
    importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, kDropped);
    importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE,
                                aiPrimitiveType_POINT | aiPrimitiveType_LINE);
    const std::string ply = PaddedPly(path);
    const std::string extension(absl::StripPrefix(path.extension().string(), "."));
    const aiScene* scene =
        ply.empty() ? importer.ReadFile(path.string(), 0)
                    : importer.ReadFileFromMemory(ply.data(), ply.size(), 0, extension.c_str());
    if (scene != nullptr) {
      if (absl::Status faces = CheckFaces(*scene); !faces.ok()) return faces;
      scene = importer.ApplyPostProcessing(kImportSteps);
    }
    if (scene == nullptr || scene->mRootNode == nullptr) {
      return absl::InvalidArgumentError(importer.GetErrorString());
    }
    TriangleMesh mesh;
    if (absl::Status nodes = AppendNodes(*scene, mesh); !nodes.ok()) return nodes;
    return mesh;
  } catch (const std::exception& e) {
    return absl::InvalidArgumentError(e.what());
  }
}

// Shares of the area that a closed surface leaves open, and of the bounding box that it encloses:
// rounding errors are less.
constexpr double kMaxOpenShare = 1e-3;
constexpr double kMinEnclosedShare = 1e-6;

// Mirrored parts are often written with all triangles turned inwards. A closed surface shows that
// by its negative volume; an open one has no outside.
void TurnOutwards(TriangleMesh& mesh) {
  const recognition::Box box = BoundsOf(mesh);
  const Eigen::Vector3d middle = (box.min + box.max) / 2;
  const auto at = [&](int i) -> Eigen::Vector3d {
    return mesh.vertices[static_cast<std::size_t>(i)].cast<double>() - middle;
  };
  Eigen::Vector3d open = Eigen::Vector3d::Zero();
  double area = 0;
  double volume = 0;
  for (const auto& [i, j, k] : mesh.triangles) {
    const Eigen::Vector3d a = at(i);
    const Eigen::Vector3d b = at(j);
    const Eigen::Vector3d c = at(k);
    const Eigen::Vector3d normal = (b - a).cross(c - a) / 2;
    open += normal;
    area += normal.norm();
    volume += a.dot(b.cross(c)) / 6;
  }
  const double enclosed = kMinEnclosedShare * (box.max - box.min).prod();
  if (open.norm() > kMaxOpenShare * area || volume >= -enclosed) return;
  for (std::array<int, 3>& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
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
  if (absl::Status ply = CheckPly(path); !ply.ok()) return ply;
  absl::StatusOr<TriangleMesh> mesh = Import(path);
  if (!mesh.ok()) return Bad(path, std::string(mesh.status().message()));
  for (Eigen::Vector3f& v : mesh->vertices) v *= static_cast<float>(unit_scale_m);
  if (absl::Status checked = CheckMesh(*mesh); !checked.ok()) {
    return Bad(path, std::string(checked.message()));
  }
  TurnOutwards(*mesh);
  return mesh;
}

absl::Status WriteMeshPly(const std::filesystem::path& path, const TriangleMesh& mesh) {
  if (absl::Status checked = CheckMesh(mesh); !checked.ok()) return checked;
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
  return WriteFileAtomically(path, bytes, Durability::kProcessCrash);
}

}  // namespace graspdb::client
