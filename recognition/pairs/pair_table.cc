#include "recognition/pairs/pair_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace graspdb::recognition {
namespace {

// Points that are nearer to each other make no pair, in bins of the distance: the line between them
// would be mostly noise.
constexpr float kMinPairBins = 0.75F;

// The bin of an angle by its cosine, from a table: at most 0.06 degrees off, and 4 degrees next to
// 0 and 180 degrees, where no bin ends.
class AngleBins {
 public:
  AngleBins() {
    for (int i = 0; i < kSteps; ++i) {
      const float angle =
          std::acos(std::clamp((static_cast<float>(i) + 0.5F) * 2 / kSteps - 1, -1.0F, 1.0F));
      bins_[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(
          std::min(static_cast<int>(angle * (PairTable::kAngleBins / std::numbers::pi_v<float>)),
                   PairTable::kAngleBins - 1));
    }
  }
  int Of(float cosine) const {
    const auto i = static_cast<int>((cosine + 1) * kHalf);
    return bins_[static_cast<std::size_t>(std::clamp(i, 0, kSteps - 1))];
  }

 private:
  static constexpr int kSteps = 4096;
  static constexpr float kHalf = kSteps / 2.0F;
  std::array<std::uint8_t, kSteps> bins_;
};

int AngleBin(float cosine) {
  static const AngleBins bins;
  return bins.Of(cosine);
}

}  // namespace

ReferenceFrame::ReferenceFrame(const Eigen::Vector3f& origin_point, const Eigen::Vector3f& normal)
    : origin(origin_point) {
  const Eigen::Vector3f across = normal.unitOrthogonal();
  to_local.row(0) = normal;
  to_local.row(1) = across;
  to_local.row(2) = normal.cross(across);
}

std::uint16_t ReferenceFrame::TurnOf(const Eigen::Vector3f& p) const {
  const Eigen::Vector3f local = to_local * (p - origin);
  const float turn = std::atan2(local.z(), local.y());  // -pi to pi
  constexpr float kPerRadian = 65536 / (2 * std::numbers::pi_v<float>);
  return static_cast<std::uint16_t>(static_cast<std::int32_t>(std::floor(turn * kPerRadian)));
}

std::optional<PairFeature> FeatureOf(const Eigen::Vector3f& p1, const Eigen::Vector3f& n1,
                                     const Eigen::Vector3f& p2, const Eigen::Vector3f& n2) {
  const Eigen::Vector3f d = p2 - p1;
  const float length = d.norm();
  if (length <= 0) return std::nullopt;
  const Eigen::Vector3f unit = d / length;
  constexpr int kBins = PairTable::kAngleBins;
  const int angles =
      (AngleBin(n1.dot(unit)) * kBins + AngleBin(n2.dot(unit))) * kBins + AngleBin(n1.dot(n2));
  return PairFeature{length, static_cast<std::uint16_t>(angles)};
}

PairTable::PairTable(const OrientedCloud& points, float diameter_m, std::size_t crowded)
    : bins_per_m_(kDistanceBins / diameter_m) {
  constexpr std::size_t kBuckets =
      static_cast<std::size_t>(kAngleBins) * kAngleBins * kAngleBins * kDistanceBins;
  const std::size_t n = points.points.size();
  const float min_distance = kMinPairBins / bins_per_m_;
  std::vector<int> bucket_of(n * n, -1);
  std::vector<std::uint32_t> counts(kBuckets, 0);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      if (i == j || (points.points[i] - points.points[j]).norm() < min_distance) continue;
      const auto feature =
          FeatureOf(points.points[i], points.normals[i], points.points[j], points.normals[j]);
      const int bucket = feature ? BucketOf(*feature) : -1;
      bucket_of[i * n + j] = bucket;
      if (bucket >= 0) counts[static_cast<std::size_t>(bucket)] += 1;
    }
  }
  begins_.resize(kBuckets + 1);
  std::uint32_t begin = 0;
  for (std::size_t b = 0; b < kBuckets; ++b) {
    begins_[b] = begin;
    if (counts[b] > crowded) counts[b] = 0;
    begin += counts[b];
  }
  begins_[kBuckets] = begin;
  entries_.resize(begin);
  std::vector<std::uint32_t> at(begins_.begin(), begins_.end() - 1);
  for (std::size_t i = 0; i < n; ++i) {
    const ReferenceFrame frame(points.points[i], points.normals[i]);
    for (std::size_t j = 0; j < n; ++j) {
      const int bucket = bucket_of[i * n + j];
      if (bucket < 0 || counts[static_cast<std::size_t>(bucket)] == 0) continue;
      entries_[at[static_cast<std::size_t>(bucket)]++] = {static_cast<std::uint16_t>(i),
                                                          frame.TurnOf(points.points[j])};
    }
  }
}

}  // namespace graspdb::recognition
