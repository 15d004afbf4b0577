// SIMD arithmetic, with the longest vectors of the processor.
//
// Every function exists twice: built for any processor, and for those with AVX2. Both do the same
// operations in the same order (eight sums side by side, added up at the end, no fused
// multiply-add), so that they give the same bits.
#pragma once

#include <cstddef>
#include <cstdint>

#include "recognition/simd/surface_kernels.h"

namespace graspdb::recognition::simd {

// Arrays of floats are read in steps of this many; their lengths are multiples of it.
inline constexpr std::size_t kLanes = 8;

// `count` rounded up to a multiple of kLanes.
constexpr std::size_t Padded(std::size_t count) { return (count + kLanes - 1) / kLanes * kLanes; }

// Arrays of bytes are read in steps of this many.
inline constexpr std::size_t kByteLanes = 32;
constexpr std::size_t PaddedBytes(std::size_t count) {
  return (count + kByteLanes - 1) / kByteLanes * kByteLanes;
}

// Padding of coordinates: far from everything, m.
inline constexpr float kFar = 1e15F;

// Sums over the points within a radius of one, relative to it, along the axes of their frame.
struct Moments {
  float count = 0;
  float first[3] = {};   // x, y, z, m
  float second[6] = {};  // xx, xy, xz, yy, yz, zz, m^2
};

// One row of a depth image: pixel u with count c is the point z * (column[u], row, 1) of the sensor
// frame with z = unit * c, moved into a world frame.
struct DepthRow {
  const std::uint16_t* counts = nullptr;
  const float* column = nullptr;  // x at a depth of 1 m, a value a pixel
  float row = 0;                  // y at a depth of 1 m
  float unit = 0;                 // m
  float farthest = 0;             // maximum distance from the sensor, m
  Rigid world_sensor = {};
  float min[3] = {};  // of the region, world frame, m
  float max[3] = {};
  std::size_t width = 0;  // any number
};

// A row of cells along x, relative to a middle one.
struct BallRow {
  int z;
  int y;
  int half;  // cells to either side
};

// Cubic cells in blocks, and the nearest point of each. Blocks that a row meets must exist.
struct Cells {
  BlockTable blocks;
  float cell_m;
  float* best;  // squared distance of the nearest point from the centre, m^2
  std::int32_t* nearest;
};

struct Functions {
  const char* name;

  // Writes count floats.
  void (*squared_distances)(const Coordinates& points, const float* query, float* out);
  // How many values are at most `limit`.
  std::size_t (*count_up_to)(const float* values, std::size_t count, float limit);
  // The sum of the square roots of the values that are at most `limit`.
  float (*sum_roots_up_to)(const float* values, std::size_t count, float limit);
  Moments (*moments)(const Coordinates& points, const float* query, float squared_radius);
  // How many points are at most `distance` from the plane normal * p = offset; all in metres.
  std::size_t (*count_near_plane)(const Coordinates& points, const float* normal, float offset,
                                  float distance);
  // For `count` rows of `row_bytes` bytes, one behind the other, the squared distance of each from
  // `query`; row_bytes is a multiple of kByteLanes.
  void (*byte_distances)(const std::uint8_t* rows, std::size_t row_bytes, std::size_t count,
                         const std::uint8_t* query, std::int32_t* out);
  // sum (a - b)^2 / (a + b); nothing where a + b is 0.
  float (*chi_square)(const float* a, const float* b, std::size_t count);
  // Updates the cells in the rows around the cell of `at` (in cells) with a point: those whose
  // `best` is larger take its squared distance, and `index`. All that a row meets are at 0 or more.
  void (*spread)(const BallRow* rows, std::size_t row_count, const float* at, std::int32_t index,
                 const Cells& cells);
  // Writes the world coordinates of the row's pixels and whether each was measured and lies in
  // the region (1) or not (0); `width` of each.
  void (*unproject)(const DepthRow& row, float* x, float* y, float* z, std::uint8_t* inside);
  // Writes for each pixel of the row on which pixel of the window its point lies, counted from
  // (0, 0), and its depth in metres; -1 where it lies on none or was not measured.
  void (*locate)(const DepthRow& row, const DepthWindow& window, std::int32_t* at, float* depth);

  // Residuals of each point to the nearest of the surface, where their normals agree: across the
  // surface, and along it past its end; Tukey's weights.
  NormalEquations (*accumulate_point_to_plane)(const PointToPlaneResiduals& residuals);
  // Residuals of each such edge along its surface to the scan's nearest point, where their normals
  // agree; Tukey's weights.
  NormalEquations (*accumulate_edges)(const EdgeResiduals& residuals);
  // `to_from` moves the points into the surface's frame; `spacing` is that of its points.
  Support (*support)(const Coordinates& points, const Rigid& to_from, const LookUp& surface,
                     float spacing, float tolerance);
  // Moves a surface into the sensor frame, and flags (1 or 0) the points that face the sensor:
  // where the cosine between normal and line of sight is at least `min_facing`, more than 0.
  void (*face)(const OrientedCoordinates& surface, const Rigid& sensor_surface, float min_facing,
               float* x, float* y, float* z, std::uint8_t* facing);
  // Compares the points of a surface whose byte in `visible` is not 0 with the window. Points
  // missing in a scan of the object alone are expected with `missing_weight`.
  Seen (*look)(const OrientedCoordinates& surface, const Rigid& sensor_surface,
               const std::uint8_t* visible, const DepthWindow& window, float tolerance,
               float missing_weight);
};

// The fastest functions that this processor supports.
const Functions& Best();

// Those for any processor.
const Functions& Portable();

}  // namespace graspdb::recognition::simd
