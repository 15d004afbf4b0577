// Depth maps in HDF5 files, as BigBIRD has them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>

#include "absl/status/statusor.h"
#include "recognition/base/types.h"

namespace graspdb::client {

// A depth camera with a lens. Pixels, and the distortion of Brown, "Decentering Distortion of
// Lenses", Photogrammetric Engineering 1966, in OpenCV's order: k1, k2, p1, p2, k3.
struct DepthLens {
  double fx = 0;
  double fy = 0;
  double cx = 0;
  double cy = 0;
  std::array<double, 5> distortion = {};
  double step_m = 1e-4;  // what 1 in the map means
};

inline constexpr int kDepthMapColumns = 640;
inline constexpr int kDepthMapRows = 480;

// Where the pixel (u, v) looks: x / z and y / z in the camera's frame, without the distortion.
Eigen::Vector2d DirectionOf(const DepthLens& lens, const Eigen::Vector2d& pixel);

// The dataset "depth" at `path`, 480 x 640, as an organised cloud in the camera's frame (x right, y
// down, z forward), metres; NaN where it is 0. Errors as ReadHdf5. Thread-safe.
absl::StatusOr<recognition::Points> ReadDepthMap(const std::filesystem::path& path,
                                                 const DepthLens& lens);

}  // namespace graspdb::client
