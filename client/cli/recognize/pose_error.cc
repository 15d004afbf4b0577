#include "client/cli/recognize/pose_error.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "rendering/mesh.h"
#include "rendering/mesh_file.h"

namespace graspdb::client {
namespace {

// Poses are compared at this many points of the surface ...
constexpr int kMeasuredPoints = 1000;
// ... with this many others: on a 10 cm part these are less than 0.5 mm apart, which is
// the smallest measurable error.
constexpr int kSearchedPoints = 50'000;

double AngleOf(const Eigen::Matrix3d& rotation) {
  return std::abs(Eigen::AngleAxisd(rotation).angle());
}

}  // namespace

absl::StatusOr<ObjectModels> LoadModels(const std::filesystem::path& folder,
                                        const v1::CaptureSet& set) {
  ObjectModels out;
  for (const v1::CapturedObject& object : set.objects()) {
    if (object.mesh_path().empty()) continue;
    absl::StatusOr<TriangleMesh> mesh = LoadMesh(folder / object.mesh_path());
    if (!mesh.ok()) return mesh.status();
    out[object.object_id()] = std::make_shared<const ObjectModel>(
        ObjectModel{SampleSurface(*mesh, kMeasuredPoints, /*seed=*/1),
                    recognition::PointSearch(SampleSurface(*mesh, kSearchedPoints, /*seed=*/2)),
                    DiameterOf(*mesh)});
  }
  return out;
}

double AddS(const ObjectModel& model, const recognition::Pose& truth,
            const recognition::Pose& found) {
  const recognition::Pose found_truth = found.inverse() * truth;
  double sum = 0;
  for (const auto& p : model.points) {
    const Eigen::Vector3f moved = (found_truth * p.cast<double>()).cast<float>();
    sum += std::sqrt(static_cast<double>(model.search.Nearest(moved).squared_distance));
  }
  return sum / static_cast<double>(model.points.size());
}

double RotationError(const recognition::Pose& truth, const recognition::Pose& found,
                     int symmetry_order) {
  const Eigen::Matrix3d difference = found.linear().transpose() * truth.linear();
  if (symmetry_order == 0) {
    // Only the direction of the axis counts.
    return std::acos(std::clamp(difference(2, 2), -1.0, 1.0));
  }
  double best = std::numbers::pi;
  for (int k = 0; k < std::max(1, symmetry_order); ++k) {
    const Eigen::AngleAxisd turn(2 * std::numbers::pi * k / std::max(1, symmetry_order),
                                 Eigen::Vector3d::UnitZ());
    best = std::min(best, AngleOf(difference * turn.toRotationMatrix()));
  }
  return best;
}

}  // namespace graspdb::client
