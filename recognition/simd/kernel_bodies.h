// The functions of kernels.h, included by each file that builds them for one kind of processor. No
// inline function of another header is used here: a linker that keeps one copy of it could keep
// the one that needs AVX2.
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "recognition/simd/depth_buffer_body.h"
#include "recognition/simd/lanes.h"
#include "recognition/simd/surface_body.h"

namespace graspdb::recognition::simd {
namespace {

inline void SquaredDistances(const Coordinates& points, const float* query, float* out) {
  const Floats qx = All(query[0]);
  const Floats qy = All(query[1]);
  const Floats qz = All(query[2]);
  for (std::size_t i = 0; i < points.count; i += kLanes) {
    const Floats dx = Load(points.x + i) - qx;
    const Floats dy = Load(points.y + i) - qy;
    const Floats dz = Load(points.z + i) - qz;
    const Floats squared = dx * dx + dy * dy + dz * dz;
    std::memcpy(out + i, &squared, sizeof(squared));
  }
}

inline std::size_t CountUpTo(const float* values, std::size_t count, float limit) {
  const Floats most = All(limit);
  Ints hits = {};
  for (std::size_t i = 0; i < count; i += kLanes) hits -= Load(values + i) <= most;
  return Sum(hits);
}

inline float SumRootsUpTo(const float* values, std::size_t count, float limit) {
  const Floats most = All(limit);
  Floats sum = {};
  for (std::size_t i = 0; i < count; i += kLanes) {
    const Floats v = Load(values + i);
    sum += Roots(Where(v <= most, v));
  }
  return Sum(sum);
}

inline Moments MomentsOf(const Coordinates& points, const float* query, float squared_radius) {
  const Floats qx = All(query[0]);
  const Floats qy = All(query[1]);
  const Floats qz = All(query[2]);
  const Floats radius = All(squared_radius);
  Floats count = {};
  Floats x = {};
  Floats y = {};
  Floats z = {};
  Floats xx = {};
  Floats xy = {};
  Floats xz = {};
  Floats yy = {};
  Floats yz = {};
  Floats zz = {};
  const Floats one = All(1);
  for (std::size_t i = 0; i < points.count; i += kLanes) {
    Floats dx = Load(points.x + i) - qx;
    Floats dy = Load(points.y + i) - qy;
    Floats dz = Load(points.z + i) - qz;
    const Ints near = dx * dx + dy * dy + dz * dz <= radius;
    dx = Where(near, dx);
    dy = Where(near, dy);
    dz = Where(near, dz);
    count += Where(near, one);
    x += dx;
    y += dy;
    z += dz;
    xx += dx * dx;
    xy += dx * dy;
    xz += dx * dz;
    yy += dy * dy;
    yz += dy * dz;
    zz += dz * dz;
  }
  return {
      Sum(count), {Sum(x), Sum(y), Sum(z)}, {Sum(xx), Sum(xy), Sum(xz), Sum(yy), Sum(yz), Sum(zz)}};
}

inline std::size_t CountNearPlane(const Coordinates& points, const float* normal, float offset,
                                  float distance) {
  const Floats nx = All(normal[0]);
  const Floats ny = All(normal[1]);
  const Floats nz = All(normal[2]);
  const Floats at = All(offset);
  const Floats most = All(distance);
  const Floats least = All(-distance);
  Ints hits = {};
  for (std::size_t i = 0; i < points.count; i += kLanes) {
    const Floats height =
        nx * Load(points.x + i) + ny * Load(points.y + i) + nz * Load(points.z + i) - at;
    hits -= (height <= most) & (height >= least);
  }
  return Sum(hits);
}

inline void ByteDistances(const std::uint8_t* rows, std::size_t row_bytes, std::size_t count,
                          const std::uint8_t* query, std::int32_t* out) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint8_t* __restrict row = rows + i * row_bytes;
    std::int32_t sum = 0;
    for (std::size_t j = 0; j < row_bytes; ++j) {
      const auto off = static_cast<std::int16_t>(row[j] - query[j]);
      sum += off * off;
    }
    out[i] = sum;
  }
}

inline float ChiSquare(const float* a, const float* b, std::size_t count) {
  Floats sum = {};
  for (std::size_t i = 0; i < count; i += kLanes) {
    const Floats total = Load(a + i) + Load(b + i);
    const Floats off = Load(a + i) - Load(b + i);
    sum += Where(total > All(0), off * off / total);
  }
  return Sum(sum);
}

inline void Spread(const BallRow* rows, std::size_t row_count, const float* at, std::int32_t index,
                   const Cells& cells) {
  static_assert(kLanes == std::size_t{1} << kBlockXBits);
  const Floats ramp = {0, 1, 2, 3, 4, 5, 6, 7};
  const Ints all = Ints{} + index;
  const int middle[3] = {static_cast<int>(at[0]), static_cast<int>(at[1]), static_cast<int>(at[2])};
  for (std::size_t r = 0; r < row_count; ++r) {
    const int z = middle[2] + rows[r].z;
    const int y = middle[1] + rows[r].y;
    const float dz = (static_cast<float>(z) + 0.5F - at[2]) * cells.cell_m;
    const float dy = (static_cast<float>(y) + 0.5F - at[1]) * cells.cell_m;
    const Floats beside = All(dz * dz + dy * dy);
    const int first = middle[0] - rows[r].half;
    const int last = middle[0] + rows[r].half;
    for (int block = first >> kBlockXBits; block <= last >> kBlockXBits; ++block) {
      const int cell_at[3] = {block << kBlockXBits, y, z};
      const std::int32_t begin =
          cells.blocks.begin[BlockOf(cells.blocks, cell_at)] + CellInBlock(cell_at);
      const Floats dx =
          (ramp + All(static_cast<float>(cell_at[0]) + 0.5F - at[0])) * All(cells.cell_m);
      const Floats squared = dx * dx + beside;
      float* best = cells.best + begin;
      std::int32_t* nearest = cells.nearest + begin;
      const Floats known = Load(best);
      Ints cell;
      std::memcpy(&cell, nearest, sizeof(cell));
      const Ints nearer = squared < known;
      const Floats kept = Where(nearer, squared) + Where(~nearer, known);
      cell = (nearer & all) | (~nearer & cell);
      std::memcpy(best, &kept, sizeof(kept));
      std::memcpy(nearest, &cell, sizeof(cell));
    }
  }
}

// `left` pixels from u on, at most kLanes.
[[gnu::always_inline]] inline void UnprojectSome(const DepthRow& row, std::size_t u,
                                                 std::size_t left, float* const* out,
                                                 std::uint8_t* inside) {
  Counts counts = {};
  Floats column = {};
  std::memcpy(&counts, row.counts + u, left * sizeof(counts[0]));
  std::memcpy(&column, row.column + u, left * sizeof(column[0]));
  const Floats depth = __builtin_convertvector(counts, Floats) * All(row.unit);
  const Floats right = column * depth;
  const Floats down = All(row.row) * depth;
  Ints is_inside = (depth > All(0)) & (right * right + down * down + depth * depth <=
                                       All(row.farthest * row.farthest));
  for (int axis = 0; axis < 3; ++axis) {
    const float* r = row.world_sensor.rotation[axis];
    const Floats at = All(r[0]) * right + All(r[1]) * down + All(r[2]) * depth +
                      All(row.world_sensor.translation[axis]);
    is_inside &= (at >= All(row.min[axis])) & (at <= All(row.max[axis]));
    std::memcpy(out[axis] + u, &at, left * sizeof(at[0]));
  }
  const Flags flags = FlagsOf(is_inside);
  std::memcpy(inside + u, &flags, left);
}

inline void Unproject(const DepthRow& row, float* x, float* y, float* z, std::uint8_t* inside) {
  float* const out[3] = {x, y, z};
  std::size_t u = 0;
  for (; u + kLanes <= row.width; u += kLanes) UnprojectSome(row, u, kLanes, out, inside);
  if (u < row.width) UnprojectSome(row, u, row.width - u, out, inside);
}

}  // namespace
}  // namespace graspdb::recognition::simd

// All of them, as Functions has them behind its name.
#define GRASPDB_SIMD_FUNCTIONS                                                                    \
  SquaredDistances, CountUpTo, SumRootsUpTo, MomentsOf, CountNearPlane, ByteDistances, ChiSquare, \
      Spread, Unproject, Locate, AccumulatePointToPlane, AccumulateEdges, SupportOf, Face, Look
