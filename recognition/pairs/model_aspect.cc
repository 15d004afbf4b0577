#include "recognition/pairs/model_aspect.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace graspdb::recognition {
namespace {

// Cosine between normal and line of sight below which a depth camera measures little.
constexpr float kMinMeasuredFacing = 0.15F;
// Points that lie farther behind the nearest one are hidden, m.
constexpr float kAspectHidesBehindM = 0.006F;
constexpr float kFarZ = 1e9F;
// Steeper surfaces are as if they had this slope.
constexpr float kMaxSlope = 4;
// Cells of a view, in steps of the surface: smaller ones leave holes.
constexpr float kCellSteps = 1.3F;

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
      if (places_[i].facing < kMinMeasuredFacing) continue;
      // A slanted surface is nearer beside a point, without hiding it.
      const float f = places_[i].facing;
      const float slope = std::min(kMaxSlope, std::sqrt(std::max(0.0F, 1 - f * f)) / f);
      const float behind = kAspectHidesBehindM + 2 * slope * cell_m_;
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
    if (places_[i].facing < kMinMeasuredFacing) return;
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

}  // namespace

ModelAspect AspectSeenFrom(const OrientedCloud& surface, float spacing_m,
                           const Eigen::Vector3f& center, const Eigen::Vector3f& camera,
                           std::size_t max_outline_points) {
  const AspectImage image(surface, center, camera, kCellSteps * spacing_m);
  ModelAspect out;
  out.towards_camera = (camera - center).normalized();
  out.visible = image.Visible();
  image.AddOutline(max_outline_points, &out);
  return out;
}

}  // namespace graspdb::recognition
