// The functions of kernels.h that compare points with surfaces; kernel_bodies.h contains the
// others.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "recognition/simd/lanes.h"

namespace graspdb::recognition::simd {
namespace {

// The nearest points, -1 where none is known.
inline Ints NearestIn(const NearestCells& in, const Floats3& p) {
  const Floats x = (p.x - All(in.origin[0])) * All(in.inverse_cell);
  const Floats y = (p.y - All(in.origin[1])) * All(in.inverse_cell);
  const Floats z = (p.z - All(in.origin[2])) * All(in.inverse_cell);
  const Ints inside = (x >= All(0)) & (x < All(in.size[0])) & (y >= All(0)) &
                      (y < All(in.size[1])) & (z >= All(0)) & (z < All(in.size[2]));
  const auto cell = [&](const Floats& v) {
    return __builtin_convertvector(Where(inside, v), Ints);
  };
  const Ints at[3] = {cell(x), cell(y), cell(z)};
  const Ints block = (at[2] >> kBlockYzBits) * in.blocks.layer +
                     (at[1] >> kBlockYzBits) * in.blocks.row + (at[0] >> kBlockXBits);
  constexpr int kYz = (1 << kBlockYzBits) - 1;
  constexpr int kX = (1 << kBlockXBits) - 1;
  const Ints in_block = ((at[2] & kYz) << (kBlockXBits + kBlockYzBits)) +
                        ((at[1] & kYz) << kBlockXBits) + (at[0] & kX);
  Ints nearest;
  for (std::size_t i = 0; i < kLanes; ++i) {
    nearest[i] = in.nearest[in.blocks.begin[block[i]] + in_block[i]];
  }
  return nearest | ~inside;
}

// The nearest points, 0 where none is known.
inline Ints NearestOf(const LookUp& in, const Floats3& p, Ints* known) {
  Ints nearest = NearestIn(in.near, p);
  *known = nearest >= 0;
  if (Any(~*known)) {
    nearest = (nearest & *known) | (NearestIn(in.far, p) & ~*known);
    *known = nearest >= 0;
  }
  return nearest & *known;
}

// The sums of NormalEquations, eight side by side.
struct Equations {
  Floats hessian[21] = {};
  Floats gradient[6] = {};
  Floats weight = {};
};

[[gnu::always_inline]] inline void AddRows(const Floats3& arm, const Floats3& direction,
                                           const Floats& residual, const Floats& weight,
                                           Equations* sums) {
  const Floats3 turn = Cross(arm, direction);
  const Floats row[6] = {turn.x, turn.y, turn.z, direction.x, direction.y, direction.z};
  std::size_t at = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    const Floats weighted = weight * row[i];
    sums->gradient[i] += weighted * residual;
    for (std::size_t j = i; j < 6; ++j) sums->hessian[at++] += weighted * row[j];
  }
  sums->weight += weight;
}

inline NormalEquations Added(const Equations& sums) {
  NormalEquations out;
  for (std::size_t i = 0; i < 21; ++i) out.hessian[i] = Sum(sums.hessian[i]);
  for (std::size_t i = 0; i < 6; ++i) out.gradient[i] = Sum(sums.gradient[i]);
  out.weight = Sum(sums.weight);
  return out;
}

// Adds residuals along a surface from `q`: the length of `along` beyond the spacing.
[[gnu::always_inline]] inline void AddAlong(const Floats3& along, float spacing, const Floats3& arm,
                                            const Floats& weight, const Ints& which,
                                            Equations* sums) {
  const Floats length = Roots(Dot(along, along));
  const Ints past = which & (length > All(spacing));
  if (!Any(past)) return;
  const Floats inverse = All(1) / (Where(past, length) + Where(~past, All(1)));
  AddRows(arm, Times(along, inverse), length - All(spacing), Where(past, weight), sums);
}

inline NormalEquations AccumulatePointToPlane(const PointToPlaneResiduals& in) {
  Equations sums;
  const Floats per_reach = All(1 / (in.reach * in.reach));
  const Floats3 center = All3(in.center);
  for (std::size_t i = 0; i < in.from.points.count; i += kLanes) {
    const Floats3 p = Point(in.to_from, Load3(in.from.points, i));
    Ints known;
    const Ints at = NearestOf(in.to, p, &known);
    if (!Any(known)) continue;
    const Floats3 q = Gather3(in.to.points, at);
    const Floats3 normal = Gather3(in.to.normals, at);
    const Floats3 d = Minus(p, q);
    const Floats rest = All(1) - Dot(d, d) * per_reach;
    known &= rest > All(0);
    known &= Dot(normal, Direction(in.to_from, Load3(in.from.normals, i))) >= All(in.min_agreement);
    if (!Any(known)) continue;
    const Floats weight = Where(known, rest * rest);
    const Floats3 arm = Minus(q, center);
    const Floats height = Dot(d, normal);
    AddRows(arm, normal, height, weight, &sums);
    AddAlong(Minus(d, Times(normal, height)), in.spacing, arm, weight * All(in.edge_weight), known,
             &sums);
  }
  return Added(sums);
}

inline Support SupportOf(const Coordinates& points, const Rigid& to_from, const LookUp& surface,
                         float spacing, float tolerance) {
  Floats explained = {};
  Floats squares = {};
  Floats near = {};
  const Floats per_tolerance = All(1 / (tolerance * tolerance));
  for (std::size_t i = 0; i < points.count; i += kLanes) {
    const Floats3 p = Point(to_from, Load3(points, i));
    Ints known;
    const Ints at = NearestOf(surface, p, &known);
    if (!Any(known)) continue;
    const Floats3 d = Minus(p, Gather3(surface.points, at));
    const Floats across = Dot(d, Gather3(surface.normals, at));
    const Floats along = Roots(Positive(Dot(d, d) - across * across));
    const Floats beyond = Positive(along - All(spacing));
    const Floats squared = across * across + beyond * beyond;
    const Floats weight = All(1) - squared * per_tolerance;
    known &= weight > All(0);
    explained += Where(known, weight);
    squares += Where(known, squared);
    near += Where(known, All(1));
  }
  return {Sum(explained), Sum(squares), Sum(near)};
}

inline void Face(const OrientedCoordinates& surface, const Rigid& sensor_surface, float min_facing,
                 float* x, float* y, float* z, std::uint8_t* facing) {
  const Floats threshold = All(min_facing * min_facing);
  // Nearer to the lens, image coordinates do not fit a float, m.
  const Floats nearest = All(1e-6F);
  for (std::size_t i = 0; i < surface.points.count; i += kLanes) {
    const Floats3 p = Point(sensor_surface, Load3(surface.points, i));
    const Floats3 normal = Direction(sensor_surface, Load3(surface.normals, i));
    const Floats towards = -Dot(normal, p);
    const Ints faces =
        (p.z > nearest) & (towards > All(0)) & (towards * towards >= threshold * Dot(p, p));
    std::memcpy(x + i, &p.x, sizeof(p.x));
    std::memcpy(y + i, &p.y, sizeof(p.y));
    std::memcpy(z + i, &p.z, sizeof(p.z));
    const Flags flags = FlagsOf(faces);
    std::memcpy(facing + i, &flags, sizeof(flags));
  }
}

}  // namespace
}  // namespace graspdb::recognition::simd
