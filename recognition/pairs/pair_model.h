// An object's surface for the search by point pairs (Drost et al. 2010), and how it looks from
// every side.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "recognition/base/types.h"
#include "recognition/pairs/image_model.h"

namespace graspdb::recognition {

// A frame at an oriented point, whose x axis is the normal: turns about it are counted from its y
// axis. The scene's and the model's points take theirs by the same rule.
struct ReferenceFrame {
  ReferenceFrame(const Eigen::Vector3f& origin_point, const Eigen::Vector3f& normal);
  // The turn of `p` about the normal; 65536 is a whole turn.
  std::uint16_t TurnOf(const Eigen::Vector3f& p) const;

  Eigen::Vector3f origin;
  Eigen::Matrix3f to_local;  // its rows: the normal and the axes across it
};

// The feature of a pair of points (Drost et al. 2010, section 3.2): distance, and the angles
// between both normals and the line between the points, and between the normals.
struct PairFeature {
  float length_m = 0;
  std::uint16_t angles = 0;  // the bins of the three angles, as one number
};

// None for points that coincide.
std::optional<PairFeature> FeatureOf(const Eigen::Vector3f& p1, const Eigen::Vector3f& n1,
                                     const Eigen::Vector3f& p2, const Eigen::Vector3f& n2);

// Pairs of a model's points by their feature. Immutable.
class PairTable {
 public:
  static constexpr int kAngleBins = 15;  // of 12 degrees
  static constexpr int kDistanceBins = 20;

  struct Entry {
    std::uint16_t point = 0;  // the first of the pair, of the model
    std::uint16_t turn = 0;   // of the second about the normal of the first; 65536 is a whole turn
  };

  // Of the points of a surface with this diameter; buckets with more than `crowded` entries are
  // emptied, since they say little. O(n^2) for n points.
  PairTable(const OrientedCloud& points, float diameter_m, std::size_t crowded);

  // The pairs with this feature; none where it is longer than the diameter.
  std::span<const Entry> Find(const PairFeature& feature) const {
    const int bucket = BucketOf(feature);
    if (bucket < 0) return {};
    const std::uint32_t begin = begins_[static_cast<std::size_t>(bucket)];
    return {entries_.data() + begin, begins_[static_cast<std::size_t>(bucket) + 1] - begin};
  }

  std::size_t bytes() const {
    return begins_.size() * sizeof(begins_[0]) + entries_.size() * sizeof(Entry);
  }

 private:
  // -1 where the points are too far apart.
  int BucketOf(const PairFeature& feature) const {
    const auto distance = static_cast<int>(feature.length_m * bins_per_m_);
    return distance < kDistanceBins ? feature.angles * kDistanceBins + distance : -1;
  }

  float bins_per_m_;
  std::vector<std::uint32_t> begins_;  // of each bucket in entries_, and the end
  std::vector<Entry> entries_;
};

struct PairModelParameters {
  // Spacing of the points: this share of the diameter, at least min_step_m metres, and as much more
  // as it takes to have at most max_points.
  float step_share = 0.05F;
  float min_step_m = 0.004F;
  std::size_t max_points = 450;
  std::size_t min_points = 20;
  ImageModelParameters surface;
  // Evenly spread sides from which the object is looked at.
  int direction_count = 200;
  // Of a stored aspect.
  std::size_t max_outline_points = 64;
};

// Immutable; safe for concurrent reads.
struct PairModel : ImageModel {
  OrientedCloud points;                // of the pairs, sparser than the surface
  float step_m = 0;                    // between their neighbours
  std::vector<ReferenceFrame> frames;  // of `points`
  std::unique_ptr<const PairTable> table;
  std::vector<ModelAspect> aspects;

  // The aspect from the direction nearest to `towards_camera` (object frame).
  const ModelAspect& AspectFrom(const Eigen::Vector3f& towards_camera) const;
  std::size_t bytes() const;
};

// From the points of a whole surface (object frame, m; unit normals outwards), or of as much of it
// as is known. Null with fewer than min_points points after thinning. Deterministic; about 0.2 s.
std::shared_ptr<const PairModel> MakePairModel(const OrientedCloud& surface,
                                               const PairModelParameters& parameters);

}  // namespace graspdb::recognition
