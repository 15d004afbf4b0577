// A scan as an image: what every step without clusters reads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "recognition/base/cancellation.h"
#include "recognition/base/types.h"
#include "recognition/points/plane.h"
#include "recognition/points/scan.h"

namespace graspdb::recognition {

struct FrameParameters {
  // Focal length of the image in pixels. Images with a longer one are thinned, so that a pixel is
  // about 1.5 mm wide at 0.8 m.
  double max_focal_px = 620;
  // And those with more pixels: 21 bytes each.
  double max_pixels = 1e6;
  // A cloud without image order is rendered with this focal length.
  double cloud_focal_px = 300;
  // Radius of the neighbourhood of a normal, m.
  float normal_radius_m = 0.010F;
  // A pixel at least this much nearer or farther than both neighbours of a row or column lies
  // between two surfaces, as a share of its depth: depth cameras invent such pixels.
  float flying_share = 0.012F;
  // Points nearer to the table belong to it, m; grows with the square of the distance from 0.8 m.
  double table_distance_m = 0.008;
  // Of an image's part around points of interest, m.
  float margin_m = 0.05F;
  // Points lower than this below the table, m, are background: they are evidence, but no part of
  // any object.
  double background_below_m = 0.02;
};

// What a pixel shows.
enum class PixelRole : std::uint8_t {
  kNone,        // no measurement
  kObject,      // above the table, in the region
  kExplained,   // of these, on an object that was already found
  kTable,       // the table
  kBackground,  // outside of the region, or below the table
};

// A pinhole image of a scan in the sensor frame. Safe for concurrent reads. After MakeFrame only
// roles change, from kObject to kExplained.
struct Frame {
  CameraIntrinsics camera;
  // Row by row, m along the optical axis; 0 where nothing was measured.
  std::vector<float> depth;
  std::vector<PixelRole> role;
  // Unit normals towards the sensor, sensor frame; zero where unknown. Of object pixels only.
  Normals normals;
  std::optional<Plane> table;            // sensor frame
  Pose world_sensor = Pose::Identity();  // T_world_sensor
  float noise_at_1m = 0.002F;            // deviation of a depth measurement, m

  bool Contains(int u, int v) const {
    return u >= 0 && v >= 0 && u < camera.width && v < camera.height;
  }
  std::size_t PixelAt(int u, int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(camera.width) +
           static_cast<std::size_t>(u);
  }
  Eigen::Vector3f PointAt(int u, int v, float z) const {
    return {
        (static_cast<float>(u) - static_cast<float>(camera.cx)) * z / static_cast<float>(camera.fx),
        (static_cast<float>(v) - static_cast<float>(camera.cy)) * z / static_cast<float>(camera.fy),
        z};
  }
  // The position of the pixel that shows a point of the sensor frame; -1 where none does.
  std::ptrdiff_t PixelOf(const Eigen::Vector3f& p) const {
    constexpr float kNearest = 0.02F;
    if (!(p.z() > kNearest)) return -1;
    // From the image's corner: a pixel begins half a pixel before its centre.
    const float u =
        static_cast<float>(camera.fx) * p.x() / p.z() + static_cast<float>(camera.cx) + 0.5F;
    const float v =
        static_cast<float>(camera.fy) * p.y() / p.z() + static_cast<float>(camera.cy) + 0.5F;
    const bool inside = u >= 0 && v >= 0 && u < static_cast<float>(camera.width) &&
                        v < static_cast<float>(camera.height);  // false for NaN
    if (!inside) return -1;
    return static_cast<std::ptrdiff_t>(PixelAt(static_cast<int>(u), static_cast<int>(v)));
  }
  // The point that a pixel shows at depth z, m.
  Eigen::Vector3f PointAt(std::size_t pixel, float z) const {
    const auto width = static_cast<std::size_t>(camera.width);
    return PointAt(static_cast<int>(pixel % width), static_cast<int>(pixel / width), z);
  }
  // Deviation of a depth measurement at `z` metres, m.
  float NoiseAt(float z) const { return noise_at_1m * z * z; }
};

// The image of `scan`: that of its depth image or of its organised cloud, thinned where it is
// large; other clouds are rendered, the nearest point a pixel. `table` (world frame) and `region`
// (world frame) say which pixels show what. Depths under 5 cm and over 100 m are none. O(n).
// Cancelled within some milliseconds; the result is then meaningless. Empty (width 0) where no
// camera could have measured the points.
//
// With points of interest (sensor frame, m), only the part of the image around them.
Frame MakeFrame(const Scan& scan, const Pose& world_sensor, const std::optional<Plane>& table,
                const Box& region, const FrameParameters& parameters,
                const IsCancelled& is_cancelled, const Points& of_interest = {});

}  // namespace graspdb::recognition
