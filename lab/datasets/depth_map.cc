#include "lab/datasets/depth_map.h"

#include <limits>

#include "lab/datasets/hdf5_file.h"

namespace graspdb::client {
namespace {

using Eigen::Vector2d;

// Lenses of depth cameras are mild: each step takes off most of what is left.
constexpr int kSteps = 10;

}  // namespace

Vector2d DirectionOf(const DepthLens& lens, const Vector2d& pixel) {
  const auto& [k1, k2, p1, p2, k3] = lens.distortion;
  const Vector2d seen((pixel.x() - lens.cx) / lens.fx, (pixel.y() - lens.cy) / lens.fy);
  Vector2d p = seen;
  // The distortion has no inverse in closed form: it is taken off again and again, where the last
  // guess says how large it is.
  for (int i = 0; i < kSteps; ++i) {
    const double r2 = p.squaredNorm();
    const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
    const Vector2d tangential(2 * p1 * p.x() * p.y() + p2 * (r2 + 2 * p.x() * p.x()),
                              p1 * (r2 + 2 * p.y() * p.y()) + 2 * p2 * p.x() * p.y());
    p = (seen - tangential) / radial;
  }
  return p;
}

absl::StatusOr<recognition::Points> ReadDepthMap(const std::filesystem::path& path,
                                                 const DepthLens& lens) {
  const auto map = ReadHdf5(path, "depth", kDepthMapRows, kDepthMapColumns);
  if (!map.ok()) return map.status();
  recognition::Points out;
  out.reserve(static_cast<std::size_t>(map->size()));
  for (int v = 0; v < kDepthMapRows; ++v) {
    for (int u = 0; u < kDepthMapColumns; ++u) {
      const double z = (*map)(v, u) * lens.step_m;
      if (z > 0) {
        out.emplace_back((z * DirectionOf(lens, {u, v}).homogeneous()).cast<float>());
      } else {
        out.emplace_back(Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
      }
    }
  }
  return out;
}

}  // namespace graspdb::client
