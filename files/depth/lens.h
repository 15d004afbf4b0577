// Lens distortion of depth images.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "files/depth/camera_entries.h"

namespace graspdb::files {

struct Lens {
  // k1, k2, p1, p2, k3, k4, k5, k6 in OpenCV's order: radial, tangential, radial, and the radial
  // coefficients of the divisor. They map undistorted places to those of the image. All 0: no
  // distortion.
  std::array<double, 8> coefficients = {};

  bool is_distorted() const { return coefficients != std::array<double, 8>{}; }
};

// Where the ray of an image's place is at a depth of 1 m without the distortion; both relative to
// the principal point, in focal lengths. nullopt where the lens has no such ray.
std::optional<Eigen::Vector2d> Undistorted(const Lens& lens, const Eigen::Vector2d& place);

// The lens that a camera file describes. INVALID_ARGUMENT with the key, without the file's name,
// for what cannot be undone here: other models than Brown's, such as those of fisheye lenses;
// skewed pixels; RealSense's `coeffs` without their `model`; other numbers of coefficients.
absl::StatusOr<Lens> LensOf(const std::vector<CameraEntry>& entries);

}  // namespace graspdb::files
