#include "client/cell/sensors/lens_table.h"

#include <cmath>
#include <cstddef>

namespace graspdb::client {

std::vector<std::int32_t> LensTable(const recognition::CameraIntrinsics& camera,
                                    const std::array<double, 5>& distortion) {
  const auto [k1, k2, p1, p2, k3] = distortion;
  std::vector<std::int32_t> table;
  table.reserve(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height));
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const double x = (u - camera.cx) / camera.fx;
      const double y = (v - camera.cy) / camera.fy;
      const double r2 = x * x + y * y;
      const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
      const double lens_x = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x);
      const double lens_y = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y;
      const double column = std::round(camera.fx * lens_x + camera.cx);
      const double row = std::round(camera.fy * lens_y + camera.cy);
      const bool inside = column >= 0 && column < camera.width && row >= 0 && row < camera.height;
      table.push_back(inside ? static_cast<std::int32_t>(row) * camera.width +
                                   static_cast<std::int32_t>(column)
                             : -1);
    }
  }
  return table;
}

}  // namespace graspdb::client
