// A scan as a coarse depth image.
#pragma once

#include <span>
#include <vector>

#include "recognition/segmentation/segmentation.h"
#include "recognition/simd/surface_kernels.h"

namespace graspdb::recognition {

// A rectangle of square pixels; pixel (0, 0) of all of them begins on the optical axis.
struct PixelWindow {
  // Angle of a pixel, rad: coarser than a Kinect's, so that a surface leaves no holes; 3 mm at
  // 0.85 m.
  static constexpr float kPitch = 0.0035F;

  Eigen::Vector2i low = Eigen::Vector2i::Zero();
  Eigen::Vector2i size = Eigen::Vector2i::Zero();

  bool is_empty() const { return (size.array() <= 0).any(); }
  bool Contains(const PixelWindow& other) const {
    return (other.low.array() >= low.array()).all() &&
           (other.high().array() <= high().array()).all();
  }
  Eigen::Vector2i high() const { return low + size; }
  // x/z and y/z where it begins.
  Eigen::Array2f origin() const { return kPitch * low.cast<float>().array(); }

  // The pixel of a point (sensor frame, z > 0), from `low`; negative for a point beside the window.
  Eigen::Vector2i PixelOf(const Eigen::Vector3f& p) const;

  // For SIMD code: depths, that of the first pixel first, whose rows begin `row` places apart.
  simd::DepthWindow Of(const float* depths, std::size_t row) const;
};

// Depths of the points of a scan, organised or not, the nearest of each pixel. Made once for all
// segments of a scan: O(n) in its points, and 16 MB at most. Immutable; safe for concurrent reads.
// The scan must outlive it.
class ScanDepths {
 public:
  // Of the surroundings of `segments`. Nothing where they are too far apart; then each window is
  // made on demand.
  explicit ScanDepths(const Scan& scan, std::span<const Segment> segments = {});

  // The window around a segment; empty where no camera could have measured it.
  PixelWindow WindowAround(const Segment& segment) const;

  // Writes the depths of `window` from `depths[begin]` on, in rows that begin `row` places apart: m
  // along z, negative; 0 where there is none.
  void Copy(const PixelWindow& window, std::size_t begin, std::size_t row,
            std::vector<float>* depths) const;

  const Scan& scan() const { return scan_; }

 private:
  ScanDepths(const Scan& scan, const PixelWindow& window) : scan_(scan) { Fill(window); }

  void Fill(const PixelWindow& window);
  void PutImage(const DepthImage& image);
  void PutCloud(const Points& points);

  const Scan& scan_;
  PixelWindow window_;
  std::vector<float> depths_;
};

// No depth camera measures nearer, m: such a point is nearly beside the lens, and one of them would
// make a window of maximum width.
inline constexpr float kNearestM = 0.01F;
inline bool IsMeasured(const Eigen::Vector3f& p) { return p.allFinite() && p.z() > kNearestM; }

}  // namespace graspdb::recognition
