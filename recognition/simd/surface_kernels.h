// Surfaces as the functions of kernels.h take them: oriented points, look-ups, lines of sight.
#pragma once

#include <cstddef>
#include <cstdint>

namespace graspdb::recognition::simd {

// Coordinates of points, apart from each other: metres, any common frame.
struct Coordinates {
  const float* x = nullptr;
  const float* y = nullptr;
  const float* z = nullptr;
  std::size_t count = 0;  // a multiple of kLanes
};

// Points and their unit normals; those of padding are zero.
struct OrientedCoordinates {
  Coordinates points;
  Coordinates normals;
};

// T_a_b: p_a = rotation * p_b + translation, metres.
struct Rigid {
  float rotation[3][3] = {};
  float translation[3] = {};
};

// Sizes of blocks of cells along x, y and z, as powers of two: SIMD code reads a row of a block at
// once.
inline constexpr int kBlockXBits = 3;
inline constexpr int kBlockYzBits = 2;
inline constexpr int kBlockCells = 1 << (kBlockXBits + 2 * kBlockYzBits);

// Where the cells of each block begin; block (x, y, z) is at z * layer + y * row + x.
struct BlockTable {
  const std::int32_t* begin = nullptr;  // at least one
  std::int32_t row = 0;
  std::int32_t layer = 0;
};

// The position of the block of cell (x, y, z) in its table, and that of the cell in its block.
template <typename Cell>
inline std::int32_t BlockOf(const BlockTable& table, const Cell& at) {
  return (at[2] >> kBlockYzBits) * table.layer + (at[1] >> kBlockYzBits) * table.row +
         (at[0] >> kBlockXBits);
}
template <typename Cell>
inline std::int32_t CellInBlock(const Cell& at) {
  constexpr int kYz = (1 << kBlockYzBits) - 1;
  constexpr int kX = (1 << kBlockXBits) - 1;
  return ((at[2] & kYz) << (kBlockXBits + kBlockYzBits)) + ((at[1] & kYz) << kBlockXBits) +
         (at[0] & kX);
}

// Cells of one size of a NearestGrid; metres.
struct NearestCells {
  const std::int32_t* nearest = nullptr;  // a cell's nearest point, -1: none; at least one block
  BlockTable blocks = {};
  float origin[3] = {};
  float inverse_cell = 0;
  float size[3] = {};  // cells along each axis
};

// A cloud with a NearestGrid over it, in one frame; metres.
struct LookUp {
  NearestCells near;
  NearestCells far;               // used where `near` has no point
  const float* points = nullptr;  // three floats each, at least one point
  const float* normals = nullptr;
};

// Point-to-plane residuals of oriented points to a surface.
struct PointToPlaneResiduals {
  OrientedCoordinates from;
  Rigid to_from;
  LookUp to;
  float center[3] = {};     // turns are about it, frame of `to`
  float reach = 0;          // maximum distance, m
  float spacing = 0;        // of the surface's points, m
  float edge_weight = 0;    // of residuals along a surface past its end, against those across it
  float min_agreement = 0;  // cosine between normals that correspond
};

// Sums over rows J = [(q - center) x d, d] of residuals r along d at q, with weights w.
struct NormalEquations {
  float hessian[21] = {};  // w J J^T, its upper triangle row by row
  float gradient[6] = {};  // w r J
  float weight = 0;
};

// Depths of a camera, see DepthBuffer: a window of pixels. Three more to every side of it can be
// read and are empty.
struct DepthWindow {
  const float* depth = nullptr;  // of pixel (0, 0): m along z, negative: of something else, 0: none
  std::ptrdiff_t row = 0;        // pixels between the beginnings of rows
  float low[2] = {};             // x/z and y/z where the first pixel begins
  float pixels_per_unit = 0;     // of x/z
  float size[2] = {};            // in pixels
  bool alone = false;            // the scan shows one object alone: missing points did not exist
};

// Edges of a surface that the camera should see and did not, near the scan.
struct EdgeResiduals {
  OrientedCoordinates surface;
  Rigid scan_surface;    // from the surface's frame to that of the scan
  Rigid sensor_surface;  // and to that of the sensor
  LookUp scan;
  DepthWindow window;
  float center[3] = {};     // turns are about it, frame of the scan
  float reach = 0;          // maximum distance, m
  float spacing = 0;        // nearer points count as seen, m
  float min_facing = 0;     // cosine between normal and line of sight
  float min_agreement = 0;  // cosine between normals that correspond
};

// How well points lie on a surface.
struct Support {
  float explained = 0;  // sum of 1 - (d / tolerance)^2 over distances d below the tolerance
  float squares = 0;    // of those distances, m^2
  float near = 0;       // number of those points
};

// How much of a surface was measured where it should be; areas as the camera sees them, in points.
struct Seen {
  float all = 0;
  float expected = 0;      // visible, nothing else before it
  float found = 0;         // of that, reduced by the distance
  float confirmed = 0;     // measured there
  float contradicted = 0;  // the camera saw through it, or the segment's surface before it
  float unmeasured = 0;    // nothing was measured
};

}  // namespace graspdb::recognition::simd
