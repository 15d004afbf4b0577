#include "rendering/mesh_part.h"

#include <algorithm>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "base/status_macros.h"
#include "files/capture_sets/capture_check.h"
#include "rendering/meshes/length_unit.h"
#include "rendering/meshes/mesh_file.h"

namespace graspdb::rendering {
namespace {

constexpr double kSmallestSideM = 0.005;
constexpr double kLargestSideM = 0.6;
// Of any object: max_object_size_m of the contract is at most 5 m.
constexpr double kSmallestObjectM = 0.001;
constexpr double kLargestObjectM = 5;
constexpr double kClearanceM = 0.02;

double LargestSideM(const TriangleMesh& mesh) {
  const recognition::Box box = BoundsOf(mesh);
  return (box.max - box.min).maxCoeff();
}

bool IsPartSize(double side_m) { return side_m >= kSmallestSideM && side_m <= kLargestSideM; }

// The units in which the largest side, `units` units of the file, is within the size limits of
// parts.
std::string FittingUnits(double units) {
  std::vector<std::string> names = LengthUnitNames();
  const auto has_wrong_size = [units](const std::string& name) {
    return !IsPartSize(units * MetresOf(name).value_or(0));
  };
  // If no unit gives a valid size, all are candidates.
  if (!std::ranges::all_of(names, has_wrong_size)) std::erase_if(names, has_wrong_size);
  return absl::StrJoin(names, " or ");
}

}  // namespace

// See Object.name in the contract: [a-z0-9_.-], a letter or digit first.
std::string ObjectIdOf(const std::filesystem::path& path) {
  std::string id = absl::AsciiStrToLower(path.stem().string());
  for (char& c : id) {
    const auto byte = static_cast<unsigned char>(c);
    if (!absl::ascii_isalnum(byte) && c != '_' && c != '.') c = '-';
  }
  const std::size_t first = id.find_first_not_of("-_.");
  id = first == std::string::npos ? "mesh" : id.substr(first, files::kMaxIdLength);
  return id;
}

absl::StatusOr<TriangleMesh> LoadPartMesh(const std::filesystem::path& path, double unit_scale_m) {
  ASSIGN_OR_RETURN(TriangleMesh mesh, LoadMesh(path, unit_scale_m));
  const double side = LargestSideM(mesh);
  if (IsPartSize(side)) return mesh;
  return absl::InvalidArgumentError(
      absl::StrCat(path.string(), " is ", side, " m large, and parts have ", kSmallestSideM, " to ",
                   kLargestSideM, " m; name its unit, ", FittingUnits(side / unit_scale_m)));
}

absl::StatusOr<TriangleMesh> LoadMeshInMetres(const std::filesystem::path& path) {
  ASSIGN_OR_RETURN(TriangleMesh mesh, LoadMesh(path));
  const double side = LargestSideM(mesh);
  if (side >= kSmallestObjectM && side <= kLargestObjectM) return mesh;
  return absl::InvalidArgumentError(
      absl::StrCat(path.string(), " is ", side, " m large; this mesh must be in metres, and the ",
                   "file's unit is probably ", FittingUnits(side), "; scale it"));
}

absl::StatusOr<Workpiece> WorkpieceFromMesh(const std::filesystem::path& path,
                                            double unit_scale_m) {
  ASSIGN_OR_RETURN(TriangleMesh mesh, LoadPartMesh(path, unit_scale_m));
  const recognition::Box box = BoundsOf(mesh);
  const Eigen::Vector3d sides = box.max - box.min;
  const Eigen::Vector3d middle = (box.min + box.max) / 2;
  const Eigen::Vector3d origin(middle.x(), middle.y(), box.min.z());
  for (Eigen::Vector3f& v : mesh.vertices) v = (v.cast<double>() - origin).cast<float>();
  const double closing_rad = sides.x() <= sides.y() ? 0 : std::numbers::pi / 2;
  const double opening = std::min(sides.x(), sides.y()) + kClearanceM;
  const Eigen::Vector3d tcp(0, 0, sides.z() / 2);
  return Workpiece{.object_id = ObjectIdOf(path),
                   .display_name = path.stem().string(),
                   .stable_pose_id = "resting",
                   .symmetry_order = 1,
                   .grasps = {TopGrasp("top", tcp, closing_rad, opening)},
                   .mesh = std::move(mesh)};
}

}  // namespace graspdb::rendering
