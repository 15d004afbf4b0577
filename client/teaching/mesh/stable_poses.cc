#include "client/teaching/mesh/stable_poses.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/status_macros.h"
#include "recognition/models/surface_model.h"

namespace graspdb::client {
namespace {

using Eigen::Vector3d;
using recognition::Pose;

// Samples are denser than the points that are computed from them.
constexpr double kSampleSpacingM = recognition::kSurfaceSpacingM / 2.0;
constexpr double kMinSamples = 2000;
constexpr double kMaxSamples = 60'000;
constexpr std::uint64_t kSeed = 1;

// Points all over the surface of a mesh with their outward normals, mesh frame, m: about as dense
// as recognition's models, 60,000 at the most. Deterministic.
recognition::OrientedCloud SurfaceOf(const rendering::TriangleMesh& mesh) {
  const double wanted = rendering::AreaOf(mesh) / (kSampleSpacingM * kSampleSpacingM);
  const int count = static_cast<int>(std::clamp(wanted, kMinSamples, kMaxSamples));
  auto samples = std::make_shared<const recognition::OrientedCloud>(
      rendering::SampleOrientedSurface(mesh, count, kSeed));
  const std::vector<recognition::PosedCloud> views = {{std::move(samples)}};
  const auto fused = recognition::FuseViews(views);
  return fused ? fused->fine.cloud : recognition::OrientedCloud{};
}

// `surface` transformed by `object_mesh` (T_object_mesh) into the object's frame.
recognition::SurfaceModel Posed(const recognition::OrientedCloud& surface,
                                const recognition::Pose& object_mesh) {
  const Eigen::Isometry3f forth = object_mesh.cast<float>();
  recognition::OrientedCloud moved = surface;
  for (Eigen::Vector3f& p : moved.points) p = forth * p;
  for (Eigen::Vector3f& n : moved.normals) n = forth.linear() * n;
  return {std::move(moved), 1};
}

constexpr double kRollLiftShare = 0.005;  // of the diameter
constexpr double kContactShare = 0.002;   // of the diameter
constexpr double kSameOrientationRad = 12 * std::numbers::pi / 180;
// An object that rocks between two facets on which it often comes to rest has two stable poses: a
// few degrees are some millimetres at its ends, which a pose upright on the table cannot represent.
constexpr double kCommon = 0.05;
constexpr double kRockingRad = 1 * std::numbers::pi / 180;
constexpr double kNextFacetRad = 20 * std::numbers::pi / 180;  // of an object that rolls
// Stricter than recognition::AlikeM: an extra stable pose costs some views, a missing one
// detections.
constexpr double kSameLookM = 0.0015;

// Neighbouring facets of one basin; `down` is that of the most probable one.
struct Orientation {
  Vector3d down;
  int basin = 0;
  double probability = 0;
  double facet_probability = 0;  // of that facet alone
  int facet_count = 0;
  bool rolls = false;
};

bool IsRocking(double probability_of_one, double of_the_other) {
  return std::min(probability_of_one, of_the_other) >= kCommon;
}

// An object rolls if the basin has a near facet of another orientation; an object that lies on its
// edge and tips over easily has none.
void MarkRolling(const std::vector<RestingFacet>& facets, const std::vector<std::size_t>& of_facet,
                 std::vector<Orientation>* orientations) {
  for (std::size_t i = 0; i < facets.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (of_facet[i] == of_facet[j] || facets[i].basin != facets[j].basin) continue;
      if (facets[i].down.dot(facets[j].down) < std::cos(kNextFacetRad)) continue;
      if (IsRocking(facets[i].probability, facets[j].probability)) continue;
      (*orientations)[of_facet[i]].rolls = true;
      (*orientations)[of_facet[j]].rolls = true;
    }
  }
}

std::vector<Orientation> OrientationsOf(const std::vector<RestingFacet>& facets) {
  std::vector<Orientation> out;
  std::vector<std::size_t> of_facet;  // position in `out`
  for (const RestingFacet& facet : facets) {
    const auto same = std::ranges::find_if(out, [&](const Orientation& a) {
      const double angle_rad =
          IsRocking(a.facet_probability, facet.probability) ? kRockingRad : kSameOrientationRad;
      return a.basin == facet.basin && a.down.dot(facet.down) > std::cos(angle_rad);
    });
    of_facet.push_back(static_cast<std::size_t>(same - out.begin()));
    if (same == out.end()) {
      out.push_back({facet.down, facet.basin, facet.probability, facet.probability, 1});
    } else {
      same->probability += facet.probability;
      ++same->facet_count;
    }
  }
  MarkRolling(facets, of_facet, &out);
  std::ranges::stable_sort(out, std::greater(), &Orientation::probability);
  return out;
}

// An orientation that does not look like an earlier one, with the surface in that orientation.
struct Look {
  Orientation orientation;
  recognition::SurfaceModel model;
};

bool LooksLike(const recognition::SurfaceModel& a, const recognition::SurfaceModel& b,
               double limit_m) {
  const auto similarity = recognition::FindShapeSimilarity(a, b);
  return similarity && similarity->gap.largest_m <= limit_m;
}

std::vector<Look> LooksOf(const rendering::TriangleMesh& mesh,
                          const std::vector<Orientation>& orientations) {
  const recognition::OrientedCloud surface = SurfaceOf(mesh);
  std::vector<Look> out;
  for (const Orientation& orientation : orientations) {
    recognition::SurfaceModel model = Posed(surface, PutDown(mesh, orientation.down));
    const auto same = std::ranges::find_if(out, [&](const Look& look) {
      const bool both_roll = orientation.rolls && look.orientation.rolls;
      return LooksLike(model, look.model, both_roll ? recognition::AlikeM(model) : kSameLookM);
    });
    if (same == out.end()) {
      out.push_back({orientation, std::move(model)});
    } else {
      same->orientation.probability += orientation.probability;
      same->orientation.facet_count += orientation.facet_count;
      same->orientation.rolls = same->orientation.rolls || orientation.rolls;
    }
  }
  std::ranges::stable_sort(out, [](const Look& a, const Look& b) {
    return a.orientation.probability > b.orientation.probability;
  });
  return out;
}

// Moves the origin to the symmetry axis, which passes through the centre of mass.
Pose OnAxis(Pose object_mesh, const Vector3d& center) {
  const Vector3d at = object_mesh * center;
  object_mesh.pretranslate(Vector3d(-at.x(), -at.y(), 0));
  return object_mesh;
}

}  // namespace

Pose PutDown(const rendering::TriangleMesh& mesh, const Vector3d& down) {
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::Quaterniond::FromTwoVectors(down, -Vector3d::UnitZ()).toRotationMatrix();
  const recognition::Box box = rendering::BoundsOf(rendering::Transformed(mesh, pose));
  const Vector3d middle = (box.min + box.max) / 2;
  pose.translation() = Vector3d(-middle.x(), -middle.y(), -box.min.z());
  return pose;
}

absl::StatusOr<MeshStablePoses> FindStablePoses(const rendering::TriangleMesh& mesh,
                                                const StablePoseChoice& choice) {
  RETURN_IF_ERROR(rendering::CheckMesh(mesh));
  ASSIGN_OR_RETURN(const ConvexHull hull, HullOf(mesh.vertices));
  MeshStablePoses out;
  out.mass = CenterOfMass(mesh, hull);
  const double diameter = rendering::DiameterOf(mesh);
  ASSIGN_OR_RETURN(const auto facets,
                   RestingFacets(hull, out.mass.center, kRollLiftShare * diameter));
  for (const Look& look : LooksOf(mesh, OrientationsOf(facets))) {
    const Orientation& a = look.orientation;
    const double tips = TipAngle(hull, out.mass.center, a.down, kContactShare * diameter);
    const bool wanted = a.probability >= choice.min_probability || tips >= choice.stands_rad;
    if (!wanted && !out.poses.empty()) {
      out.left_out += a.probability;
      continue;
    }
    MeshStablePose pose;
    pose.object_mesh = PutDown(mesh, a.down);
    pose.probability = a.probability;
    pose.tip_angle_rad = tips;
    pose.rolls = a.rolls;
    pose.facet_count = a.facet_count;
    pose.symmetry = recognition::FindSymmetry(look.model);
    if (pose.symmetry_order() != 1) pose.object_mesh = OnAxis(pose.object_mesh, out.mass.center);
    out.poses.push_back(pose);
  }
  return out;
}

}  // namespace graspdb::client
