#include "recognition/pairs/pair_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <unordered_map>

#include "recognition/base/bounds.h"
#include "recognition/points/cell_key.h"

namespace graspdb::recognition {
namespace {

// Points that are nearer to each other make no pair, in steps of the surface.
constexpr float kMinPairSteps = 1.5F;
// A bucket that holds more than this share of all pairs says little about the pose.
constexpr std::size_t kMinCrowded = 150;
// Cosine between normal and line of sight below which a depth camera measures little.
constexpr float kMinFacing = 0.15F;
// Points that lie farther behind the nearest one are hidden, m.
constexpr float kHidesBehindM = 0.006F;
constexpr float kFarZ = 1e9F;
// Steeper surfaces are as if they had this slope.
constexpr float kMaxSlope = 4;
// Cells of a view, in steps of the surface: smaller ones leave holes.
constexpr float kCellSteps = 1.3F;
// Distance of the cameras of the stored aspects, m.
constexpr float kUsualDistanceM = 0.8F;

// One point of each cell and of each side that the surface has there: the one nearest to the mean.
OrientedCloud ThinnedTo(const OrientedCloud& cloud, float cell_m) {
  struct Side {
    Eigen::Vector3f point;
    Eigen::Vector3f normal;
    float count;
  };
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> cells;
  std::vector<Side> sides;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    std::vector<std::size_t>& here = cells[CellKey(cloud.points[i], cell_m)];
    const Eigen::Vector3f& n = cloud.normals[i];
    const auto same = std::ranges::find_if(here, [&](std::size_t s) {
      return sides[s].normal.dot(n) > kSameSide * sides[s].normal.norm();
    });
    if (same == here.end()) {
      here.push_back(sides.size());
      sides.push_back({cloud.points[i], n, 1});
    } else {
      sides[*same].point += cloud.points[i];
      sides[*same].normal += n;
      sides[*same].count += 1;
    }
  }
  OrientedCloud out;
  for (const Side& side : sides) {
    out.points.push_back(side.point / side.count);
    out.normals.push_back(side.normal.normalized());
  }
  return out;
}

// Thinned to at most `max_points`, from `step_m` upwards.
OrientedCloud AtMost(std::size_t max_points, const OrientedCloud& cloud, float* step_m) {
  OrientedCloud out = ThinnedTo(cloud, *step_m);
  while (out.points.size() > max_points) {
    const auto ratio = static_cast<float>(out.points.size()) / static_cast<float>(max_points);
    *step_m *= std::max(1.03F, std::sqrt(ratio));
    out = ThinnedTo(cloud, *step_m);
  }
  return out;
}

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

// The surface as a camera sees it: a grid of cells across the line of sight to its centre, in
// metres at the centre's distance.
class AspectImage {
 public:
  AspectImage(const OrientedCloud& surface, const Eigen::Vector3f& center,
              const Eigen::Vector3f& camera, float cell_m)
      : surface_(surface), camera_(camera) {
    const Eigen::Vector3f way = camera - center;
    distance_m_ = std::max(way.norm(), kNearestCameraM);
    towards_ = way.norm() < kNearestCameraM ? Eigen::Vector3f::UnitZ() : way.normalized();
    right_ = towards_.unitOrthogonal();
    up_ = towards_.cross(right_);
    places_.reserve(surface.points.size());
    Eigen::Array2f low = Eigen::Array2f::Constant(kFarZ);
    Eigen::Array2f high = -low;
    for (std::size_t i = 0; i < surface.points.size(); ++i) {
      places_.push_back(PlaceOf(i));
      low = low.min(places_[i].across);
      high = high.max(places_[i].across);
    }
    // Points far apart, as of views with wrong poses, must not fill the memory.
    cell_m_ = std::max(cell_m, (high - low).maxCoeff() / kMaxCells);
    low_ = low - kBorder * cell_m_;
    size_ = ((high - low) / cell_m_).ceil().cast<int>() + 1 + 2 * kBorder;
    nearest_.assign(static_cast<std::size_t>(size_.x()) * static_cast<std::size_t>(size_.y()),
                    kFarZ);
    owner_.assign(nearest_.size(), -1);
    for (std::size_t i = 0; i < surface.points.size(); ++i) Splat(i);
    CloseGaps();
  }

  std::vector<std::uint16_t> Visible() const {
    std::vector<std::uint16_t> out;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      if (places_[i].facing < kMinFacing) continue;
      // A slanted surface is nearer beside a point, without hiding it.
      const float f = places_[i].facing;
      const float slope = std::min(kMaxSlope, std::sqrt(std::max(0.0F, 1 - f * f)) / f);
      const float behind = kHidesBehindM + 2 * slope * cell_m_;
      if (places_[i].depth < nearest_[CellAt(CellOf(i))] + behind) {
        out.push_back(static_cast<std::uint16_t>(i));
      }
    }
    return out;
  }

  // Cells beside which nothing is: their point and the direction off the object.
  void AddOutline(std::size_t max_points, ModelAspect* out) const {
    std::vector<std::pair<std::int32_t, Eigen::Vector3f>> all;
    for (int y = kBorder; y < size_.y() - kBorder; ++y) {
      for (int x = kBorder; x < size_.x() - kBorder; ++x) {
        const std::int32_t owner = owner_[CellAt({x, y})];
        if (owner < 0) continue;
        const Eigen::Array2f off = OffAt(x, y);
        const float length = off.matrix().norm();
        if (length < 0.3F) continue;
        const Eigen::Array2f unit = off / length;
        const auto is_taken = [&](float steps) {
          return covered_[CellAt(Eigen::Array2i(x, y) + (steps * unit).round().cast<int>())] != 0;
        };
        if (is_taken(1.6F) || is_taken(2.9F)) continue;
        all.emplace_back(owner, unit.x() * right_ + unit.y() * up_);
      }
    }
    const std::size_t kept = std::min(max_points, all.size());
    for (std::size_t i = 0; i < kept; ++i) {
      const auto& [owner, outward] = all[i * all.size() / kept];
      out->outline.push_back(surface_.points[static_cast<std::size_t>(owner)]);
      out->outward.push_back(outward);
    }
  }

 private:
  static constexpr int kBorder = 4;
  static constexpr float kMaxCells = 512;  // a side, without the border
  static constexpr float kNearestCameraM = 1e-3F;

  struct Place {
    Eigen::Array2f across;  // m, at the centre's distance
    float depth = 0;        // along the line of sight to the centre, m
    float facing = 0;       // cosine between normal and line of sight
  };

  Place PlaceOf(std::size_t i) const {
    const Eigen::Vector3f ray = surface_.points[i] - camera_;
    const float depth = std::max(-ray.dot(towards_), 0.1F * distance_m_);
    const float scale = distance_m_ / depth;
    return {{scale * ray.dot(right_), scale * ray.dot(up_)},
            depth,
            -surface_.normals[i].dot(ray) / ray.norm()};
  }
  Eigen::Array2i CellOf(std::size_t i) const {
    return ((places_[i].across - low_) / cell_m_).floor().cast<int>();
  }
  std::size_t CellAt(const Eigen::Array2i& at) const {
    return static_cast<std::size_t>(at.y()) * static_cast<std::size_t>(size_.x()) +
           static_cast<std::size_t>(at.x());
  }

  // A point that faces the camera hides the cells around it too, so that a surface has no holes.
  void Splat(std::size_t i) {
    const float depth = places_[i].depth;
    const std::size_t middle = CellAt(CellOf(i));
    std::int32_t& owner = owner_[middle];
    if (owner < 0 || places_[static_cast<std::size_t>(owner)].depth > depth) {
      owner = static_cast<std::int32_t>(i);
    }
    nearest_[middle] = std::min(nearest_[middle], depth);
    if (places_[i].facing < kMinFacing) return;
    const auto row = static_cast<std::size_t>(size_.x());
    for (const std::size_t first : {middle - row - 1, middle - 1, middle + row - 1}) {
      for (std::size_t cell = first; cell < first + 3; ++cell) {
        nearest_[cell] = std::min(nearest_[cell], depth);
      }
    }
  }

  // The cells that the object covers, with gaps between its points closed: first all cells around
  // the points, then those whose neighbours are all covered.
  void CloseGaps() {
    const auto row = static_cast<std::ptrdiff_t>(size_.x());
    const std::array<std::ptrdiff_t, 8> around = {-row - 1, -row,    -row + 1, -1,
                                                  1,        row - 1, row,      row + 1};
    std::vector<std::uint8_t> grown(owner_.size(), 0);
    const auto end = static_cast<std::ptrdiff_t>(owner_.size()) - row - 1;
    for (std::ptrdiff_t i = row + 1; i < end; ++i) {
      if (owner_[static_cast<std::size_t>(i)] < 0) continue;
      grown[static_cast<std::size_t>(i)] = 1;
      for (const std::ptrdiff_t step : around) grown[static_cast<std::size_t>(i + step)] = 1;
    }
    covered_.assign(owner_.size(), 0);
    for (std::ptrdiff_t i = row + 1; i < end; ++i) {
      std::uint8_t all = grown[static_cast<std::size_t>(i)];
      for (const std::ptrdiff_t step : around) all &= grown[static_cast<std::size_t>(i + step)];
      covered_[static_cast<std::size_t>(i)] = all;
    }
  }

  // The mean direction to empty cells around (x, y), cells.
  Eigen::Array2f OffAt(int x, int y) const {
    Eigen::Array2f out = Eigen::Array2f::Zero();
    float empty = 0;
    for (int dy = -2; dy <= 2; ++dy) {
      for (int dx = -2; dx <= 2; ++dx) {
        if (covered_[CellAt({x + dx, y + dy})] != 0) continue;
        out += Eigen::Array2f(static_cast<float>(dx), static_cast<float>(dy));
        empty += 1;
      }
    }
    return empty > 0 ? Eigen::Array2f(out / empty) : out;
  }

  const OrientedCloud& surface_;
  Eigen::Vector3f camera_;
  float distance_m_;
  float cell_m_;
  Eigen::Vector3f towards_;
  Eigen::Vector3f right_;
  Eigen::Vector3f up_;
  Eigen::Array2f low_;
  Eigen::Array2i size_;
  std::vector<Place> places_;
  std::vector<float> nearest_;  // m
  std::vector<std::int32_t> owner_;
  std::vector<std::uint8_t> covered_;
};

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
  // Any two directions across the normal will do, as long as the scene's and the model's pair use
  // the same rule for their own frame.
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

PairTable::PairTable(const OrientedCloud& points, float diameter_m, std::size_t crowded)
    : bins_per_m_(kDistanceBins / diameter_m) {
  constexpr std::size_t kBuckets =
      static_cast<std::size_t>(kAngleBins) * kAngleBins * kAngleBins * kDistanceBins;
  const std::size_t n = points.points.size();
  const float min_distance = kMinPairSteps / bins_per_m_ / 2;
  std::vector<int> bucket_of(n * n, -1);
  std::vector<std::uint32_t> counts(kBuckets + 1, 0);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      if (i == j || (points.points[i] - points.points[j]).norm() < min_distance) continue;
      const int bucket =
          BucketOf(points.points[i], points.normals[i], points.points[j], points.normals[j]);
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

int PairTable::BucketOf(const Eigen::Vector3f& p1, const Eigen::Vector3f& n1,
                        const Eigen::Vector3f& p2, const Eigen::Vector3f& n2) const {
  const Eigen::Vector3f d = p2 - p1;
  const float length = d.norm();
  const auto distance = static_cast<int>(length * bins_per_m_);
  if (distance >= kDistanceBins || length <= 0) return -1;
  const Eigen::Vector3f unit = d / length;
  return ((AngleBin(n1.dot(unit)) * kAngleBins + AngleBin(n2.dot(unit))) * kAngleBins +
          AngleBin(n1.dot(n2))) *
             kDistanceBins +
         distance;
}

std::span<const PairTable::Entry> PairTable::Find(const Eigen::Vector3f& p1,
                                                  const Eigen::Vector3f& n1,
                                                  const Eigen::Vector3f& p2,
                                                  const Eigen::Vector3f& n2) const {
  const int bucket = BucketOf(p1, n1, p2, n2);
  if (bucket < 0) return {};
  const std::uint32_t begin = begins_[static_cast<std::size_t>(bucket)];
  return {entries_.data() + begin, begins_[static_cast<std::size_t>(bucket) + 1] - begin};
}

const ModelAspect& PairModel::AspectFrom(const Eigen::Vector3f& towards_camera) const {
  return *std::ranges::max_element(aspects, {}, [&](const ModelAspect& aspect) {
    return aspect.towards_camera.dot(towards_camera);
  });
}

ModelAspect PairModel::AspectSeenFrom(const Eigen::Vector3f& camera,
                                      std::size_t max_outline_points) const {
  const AspectImage image(surface, center, camera, kCellSteps * surface_step_m);
  ModelAspect out;
  out.towards_camera = (camera - center).normalized();
  out.visible = image.Visible();
  image.AddOutline(max_outline_points, &out);
  return out;
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
  const auto bounds = BoundsOf(surface.points);
  out->center = bounds.center();
  for (const auto& p : surface.points) {
    out->diameter_m = std::max(out->diameter_m, 2 * (p - out->center).norm());
  }
  out->step_m = std::max(parameters.min_step_m, parameters.step_share * out->diameter_m);
  out->points = AtMost(parameters.max_points, surface, &out->step_m);
  if (out->points.points.size() < 20) return nullptr;
  out->surface_step_m = 0.0025F;
  out->surface = AtMost(parameters.max_surface_points, surface, &out->surface_step_m);
  const std::size_t pairs = out->points.points.size() * out->points.points.size();
  out->table = std::make_unique<const PairTable>(out->points, out->diameter_m,
                                                 std::max(kMinCrowded, pairs / 200));
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
