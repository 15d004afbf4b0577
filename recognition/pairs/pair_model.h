// An object's surface for the search by point pairs (Drost et al. 2010), and how it looks from
// every side.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "recognition/base/types.h"

namespace graspdb::recognition {

struct PairModelParameters {
  // Spacing of the points: this share of the diameter, at least min_step_m metres, and as much more
  // as it takes to have at most max_points.
  float step_share = 0.05F;
  float min_step_m = 0.004F;
  std::size_t max_points = 450;
  // Points of the denser surface that hypotheses are refined and judged on.
  std::size_t max_surface_points = 4000;
  int direction_count = 200;
  // Points of a view's outline.
  std::size_t max_outline_points = 64;
};

// What a camera sees of an object from one side.
struct ModelAspect {
  Eigen::Vector3f towards_camera = Eigen::Vector3f::UnitZ();  // object frame, unit length
  std::vector<std::uint16_t> visible;                         // positions in PairModel::surface
  // Points of the outline, and the unit direction across the line of sight that leads off the
  // object there. Object frame, m.
  Points outline;
  Normals outward;
};

// Pairs of a model by their feature. Immutable.
class PairTable {
 public:
  static constexpr int kAngleBins = 15;  // of 12 degrees
  static constexpr int kDistanceBins = 20;

  struct Entry {
    std::uint16_t point = 0;  // the first of the pair, in PairModel::points
    std::uint16_t turn = 0;   // of the second about the normal of the first; 65536 is a whole turn
  };

  // Of the points of a surface with this diameter; buckets with more than `crowded` entries are
  // emptied, since they say little.
  PairTable(const OrientedCloud& points, float diameter_m, std::size_t crowded);

  // The pairs with the same feature as (p1, n1, p2, n2); none where they are farther apart than the
  // diameter.
  std::span<const Entry> Find(const Eigen::Vector3f& p1, const Eigen::Vector3f& n1,
                              const Eigen::Vector3f& p2, const Eigen::Vector3f& n2) const;

  std::size_t bytes() const {
    return begins_.size() * sizeof(begins_[0]) + entries_.size() * sizeof(Entry);
  }

 private:
  // -1 where the points are too far apart or coincide.
  int BucketOf(const Eigen::Vector3f& p1, const Eigen::Vector3f& n1, const Eigen::Vector3f& p2,
               const Eigen::Vector3f& n2) const;

  float bins_per_m_;
  std::vector<std::uint32_t> begins_;  // of each bucket in entries_, and the end
  std::vector<Entry> entries_;
};

// The turn of `p` about the normal `n` of a reference point at `origin`, as PairTable counts it,
// and the rotation that puts `n` on the x axis and `p` on the half plane of turn 0 after it.
struct ReferenceFrame {
  ReferenceFrame(const Eigen::Vector3f& origin_point, const Eigen::Vector3f& normal);
  std::uint16_t TurnOf(const Eigen::Vector3f& p) const;

  Eigen::Vector3f origin;
  Eigen::Matrix3f to_local;  // its rows: the normal and two directions across it
};

struct PairModel {
  OrientedCloud points;   // at most 450; object frame, m
  OrientedCloud surface;  // denser, for refinement and verification
  float step_m = 0;
  float surface_step_m = 0;
  float diameter_m = 0;
  Eigen::Vector3f center = Eigen::Vector3f::Zero();  // of the bounding box
  std::vector<ReferenceFrame> frames;                // of `points`
  std::unique_ptr<const PairTable> table;
  std::vector<ModelAspect> aspects;

  // The aspect from the direction nearest to `towards_camera` (object frame).
  const ModelAspect& AspectFrom(const Eigen::Vector3f& towards_camera) const;
  // What a camera at this place (object frame, m) sees. O(n) in the surface, about 0.1 ms.
  ModelAspect AspectSeenFrom(const Eigen::Vector3f& camera, std::size_t max_outline_points) const;
  std::size_t bytes() const;
};

// From the points of a whole surface (object frame, m; unit normals outwards), or of as much of it
// as is known. Null with fewer than 20 points after thinning. Deterministic; about 0.2 s.
std::shared_ptr<const PairModel> MakePairModel(const OrientedCloud& surface,
                                               const PairModelParameters& parameters);

}  // namespace graspdb::recognition
