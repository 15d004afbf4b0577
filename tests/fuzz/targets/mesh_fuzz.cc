// Meshes: PLY, STL or OBJ by how the input begins.
#include <cstdint>
#include <string>
#include <string_view>

#include "rendering/meshes/mesh_file.h"
#include "tests/fuzz/requirement.h"
#include "tests/fuzz/scratch_folder.h"

namespace graspdb::fuzz {
namespace {

std::string NameOf(std::string_view bytes) {
  if (bytes.starts_with("ply")) return "in.ply";
  if (bytes.starts_with("v ") || bytes.starts_with("#") || bytes.starts_with("o ")) return "in.obj";
  return "in.stl";
}

void Read(std::string_view bytes) {
  static const ScratchFolder folder;
  const auto mesh = rendering::LoadMesh(folder.Write(NameOf(bytes), bytes), 0.001);
  if (!mesh.ok()) return;
  Require(rendering::CheckMesh(*mesh).ok(), "a sound mesh");
  const std::filesystem::path copy = folder.path() / "out.ply";
  Require(rendering::WriteMeshPly(copy, *mesh).ok(), "parsed data can be written");
  const auto again = rendering::LoadMesh(copy);
  Require(again.ok(), "written data can be read");
  Require(again->triangles.size() <= mesh->triangles.size(), "no triangle is made up");
}

}  // namespace
}  // namespace graspdb::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  graspdb::fuzz::Read({reinterpret_cast<const char*>(data), size});
  return 0;
}
