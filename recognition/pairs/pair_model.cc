#include "recognition/pairs/pair_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "recognition/points/thinned.h"

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

// A feature that more than one of so many pairs has, and at least kMinCrowded, says little about
// the pose.
constexpr std::size_t kPairsPerCrowded = 200;
constexpr std::size_t kMinCrowded = 150;
// Distance of the cameras of the stored aspects, m, from the surface.
constexpr float kUsualDistanceM = 0.8F;

// Evenly spread directions (Fibonacci's spiral).
std::vector<Eigen::Vector3f> Directions(int count) {
  std::vector<Eigen::Vector3f> out;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count;
    const double turn = i * std::numbers::pi * (3 - std::sqrt(5.0));
    const double r = std::sqrt(1 - z * z);
    out.push_back(Eigen::Vector3d(r * std::cos(turn), r * std::sin(turn), z).cast<float>());
  }
  return out;
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

const ModelAspect& PairModel::AspectFrom(const Eigen::Vector3f& towards_camera) const {
  return *std::ranges::max_element(aspects, {}, [&](const ModelAspect& aspect) {
    return aspect.towards_camera.dot(towards_camera);
  });
}

std::size_t PairModel::bytes() const {
  std::size_t out = sizeof(*this) + table->bytes() + frames.size() * sizeof(frames[0]) +
                    2 * sizeof(Eigen::Vector3f) * (points.points.size() + surface.points.size());
  for (const ModelAspect& aspect : aspects) {
    out += aspect.visible.size() * sizeof(aspect.visible[0]) +
           2 * sizeof(Eigen::Vector3f) * aspect.outline.size();
  }
  return out;
}

std::shared_ptr<const PairModel> MakePairModel(const OrientedCloud& surface,
                                               const PairModelParameters& parameters) {
  if (surface.points.empty()) return nullptr;
  auto out = std::make_shared<PairModel>();
  static_cast<ImageModel&>(*out) = MakeImageModel(surface, parameters.surface);
  out->step_m = std::max(parameters.min_step_m, parameters.step_share * out->diameter_m);
  out->points = ThinnedToAtMost(parameters.max_points, surface, &out->step_m);
  if (out->points.points.size() < parameters.min_points) return nullptr;
  const std::size_t pairs = out->points.points.size() * out->points.points.size();
  out->table = std::make_unique<const PairTable>(out->points, out->diameter_m,
                                                 std::max(kMinCrowded, pairs / kPairsPerCrowded));
  for (std::size_t i = 0; i < out->points.points.size(); ++i) {
    out->frames.emplace_back(out->points.points[i], out->points.normals[i]);
  }
  for (const Eigen::Vector3f& towards : Directions(parameters.direction_count)) {
    const float distance = kUsualDistanceM + out->diameter_m / 2;
    out->aspects.push_back(
        out->AspectSeenFrom(out->center + distance * towards, parameters.max_outline_points));
  }
  return out;
}

}  // namespace graspdb::recognition
