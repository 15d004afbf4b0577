// Point files: an input that begins with "ply" is a PLY file, every other one a PCD file.
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "files/points/point_file.h"
#include "tests/fuzz/requirement.h"
#include "tests/fuzz/scratch_folder.h"

namespace graspdb::fuzz {
namespace {

bool SamePoint(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  return a == b || (!a.allFinite() && !b.allFinite());
}

void RequireSame(const files::PointFile& read, const files::PointFile& again) {
  Require(again.width == read.width && again.height == read.height, "the same size after writing");
  Require(again.points.size() == read.points.size(), "the same count after writing");
  Require(again.normals.size() == read.normals.size(), "as many normals after writing");
  for (std::size_t i = 0; i < read.points.size(); ++i) {
    Require(SamePoint(read.points[i], again.points[i]), "the same points after writing");
  }
}

void Read(std::string_view bytes) {
  static const ScratchFolder folder;
  const bool is_ply = bytes.starts_with("ply");
  const auto file = files::ReadPointFile(folder.Write(is_ply ? "in.ply" : "in.pcd", bytes));
  if (!file.ok()) return;
  const auto count = static_cast<std::int64_t>(file->points.size());
  Require(std::int64_t{file->width} * file->height == count, "width x height points");
  Require(file->normals.empty() || file->normals.size() == file->points.size(),
          "a normal for each point or none");
  const std::filesystem::path copy = folder.path() / "out.pcd";
  Require(files::WritePcd(copy, *file).ok(), "parsed data can be written");
  const auto again = files::ReadPointFile(copy);
  Require(again.ok(), "written data can be read");
  RequireSame(*file, *again);
}

}  // namespace
}  // namespace graspdb::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  graspdb::fuzz::Read({reinterpret_cast<const char*>(data), size});
  return 0;
}
