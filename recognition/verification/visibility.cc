#include "recognition/verification/visibility.h"

#include <algorithm>

#include "recognition/simd/kernels.h"
#include "recognition/simd/rigid_transform.h"

namespace graspdb::recognition {
namespace {

// Cosine between normal and line of sight below which a surface is too slanted to count.
constexpr float kMinFacing = 0.2F;
// Size of the cells of the depth buffer, in units of the distance between points.
constexpr float kCellsPerSpacing = 2.5F;
// A surface hides points that lie farther behind it than this, m, or than a cell's size.
constexpr float kHidesBehindM = 0.008F;
constexpr int kMaxCellsPerSide = 512;
constexpr float kUnseenM = 1e9F;  // depth where nothing is

}  // namespace

VisibleSurface::VisibleSurface(const Surface& surface, const Eigen::Isometry3f& sensor_object)
    : x_(surface.columns.coordinates().points.count),
      y_(x_.size()),
      z_(x_.size()),
      mask_(x_.size()) {
  simd::Best().face(surface.columns.coordinates(), RigidTransform(sensor_object).rigid(),
                    kMinFacing, x_.data(), y_.data(), z_.data(), mask_.data());
  for (std::size_t i = 0; i < mask_.size(); ++i) {
    if (mask_[i] != 0) visible_.push_back(i);
  }
  if (!visible_.empty()) Hide(surface.spacing_m);
}

void VisibleSurface::Hide(float spacing_m) {
  std::vector<float> u;
  std::vector<float> v;
  u.reserve(visible_.size());
  v.reserve(visible_.size());
  float depth = kUnseenM;
  for (const std::size_t i : visible_) {
    u.push_back(x_[i] / z_[i]);
    v.push_back(y_[i] / z_[i]);
    depth = std::min(depth, z_[i]);
  }
  const auto [left, right] = std::ranges::minmax(u);
  const auto [top, bottom] = std::ranges::minmax(v);
  const float cell = std::max(kCellsPerSpacing * spacing_m / depth,
                              std::max(right - left, bottom - top) / (kMaxCellsPerSide - 1));
  const auto row = static_cast<std::size_t>((right - left) / cell) + 1;
  const auto rows = static_cast<std::size_t>((bottom - top) / cell) + 1;
  std::vector<float> nearest(row * rows, kUnseenM);
  std::vector<std::uint32_t> cell_of(visible_.size());
  for (std::size_t k = 0; k < visible_.size(); ++k) {
    const auto column = static_cast<std::uint32_t>((u[k] - left) / cell);
    const auto line = static_cast<std::uint32_t>((v[k] - top) / cell);
    cell_of[k] = line * static_cast<std::uint32_t>(row) + column;
    float& here = nearest[cell_of[k]];
    here = std::min(here, z_[visible_[k]]);
  }
  const float behind = std::max(kHidesBehindM, kCellsPerSpacing * spacing_m);
  std::size_t kept = 0;
  for (std::size_t k = 0; k < visible_.size(); ++k) {
    const std::size_t i = visible_[k];
    if (z_[i] <= nearest[cell_of[k]] + behind) {
      visible_[kept++] = i;
    } else {
      mask_[i] = 0;
    }
  }
  visible_.resize(kept);
}

}  // namespace graspdb::recognition
