// The functions of kernels.h that compare a posed surface with a camera's measurements;
// kernel_bodies.h contains the others.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "recognition/simd/lanes.h"
#include "recognition/simd/surface_body.h"

namespace graspdb::recognition::simd {
namespace {

// `left` pixels from u on, at most kLanes.
[[gnu::always_inline]] inline void LocateSome(const DepthRow& row, const DepthWindow& window,
                                              std::size_t u, std::size_t left, std::int32_t* at,
                                              float* depth) {
  Counts counts = {};
  Floats column = {};
  std::memcpy(&counts, row.counts + u, left * sizeof(counts[0]));
  std::memcpy(&column, row.column + u, left * sizeof(column[0]));
  const Floats z = __builtin_convertvector(counts, Floats) * All(row.unit);
  const Ints measured = z > All(0);
  const Floats divisor = z + Where(~measured, All(1));
  const auto place = [&](const Floats& across, float low) {
    return (across / divisor - All(low)) * All(window.pixels_per_unit);
  };
  const Floats x = place(column * z, window.low[0]);
  const Floats y = place(All(row.row) * z, window.low[1]);
  const Ints inside = measured & (x >= All(0)) & (x < All(window.size[0])) & (y >= All(0)) &
                      (y < All(window.size[1]));
  const Ints pixel =
      __builtin_convertvector(Where(inside, y), Ints) * static_cast<std::int32_t>(window.row) +
      __builtin_convertvector(Where(inside, x), Ints);
  const Ints found = pixel | ~inside;
  std::memcpy(at + u, &found, left * sizeof(found[0]));
  std::memcpy(depth + u, &z, left * sizeof(z[0]));
}

inline void Locate(const DepthRow& row, const DepthWindow& window, std::int32_t* at, float* depth) {
  std::size_t u = 0;
  for (; u + kLanes <= row.width; u += kLanes) LocateSome(row, window, u, kLanes, at, depth);
  if (u < row.width) LocateSome(row, window, u, row.width - u, at, depth);
}

// The pixels of a window on which some places lie; one beyond a window where they lie on none.
struct Pixels {
  Ints at;      // from pixel (0, 0)
  Ints inside;  // or next to it
};

inline Pixels PixelsOf(const DepthWindow& window, const Floats3& p) {
  const Floats u = (p.x / p.z - All(window.low[0])) * All(window.pixels_per_unit);
  const Floats v = (p.y / p.z - All(window.low[1])) * All(window.pixels_per_unit);
  const Ints inside = (u >= All(-1)) & (u < All(window.size[0] + 1)) & (v >= All(-1)) &
                      (v < All(window.size[1] + 1));
  // Towards zero is down where nothing is negative.
  const Ints column = __builtin_convertvector(Where(inside, u + All(1)), Ints) - 1;
  const Ints line = __builtin_convertvector(Where(inside, v + All(1)), Ints) - 1;
  return {line * static_cast<std::int32_t>(window.row) + column, inside};
}

inline Floats DepthsAt(const DepthWindow& window, const Pixels& pixels, std::ptrdiff_t step) {
  Floats depth;
  for (std::size_t i = 0; i < kLanes; ++i) depth[i] = window.depth[pixels.at[i] + step];
  return Where(pixels.inside, depth);
}

// How far measured depths are from `z`, m; very far where nothing was measured.
inline Floats Off(const Floats& depth, const Floats& z) {
  constexpr float kNothing = 1e9F;
  const Ints measured = depth != All(0);
  return Where(measured, Absolute(z - Absolute(depth))) + Where(~measured, All(kNothing));
}

// Classification of points of a posed surface. At most one of the masks is set.
struct Finding {
  Ints there;       // a surface was measured there
  Ints hidden;      // something else stands before it
  Ints denied;      // the camera looked through it, or saw the segment's surface before it
  Ints unmeasured;  // nothing was measured
  Ints missing;     // the same in a scan that shows the object alone
  Floats off;       // between claimed and measured surface, across the surface, m
};

// `slant` is the cosine between normal and line of sight: ratio of a distance across a surface to
// the one along the line of sight.
inline Finding Find(const DepthWindow& window, const Floats3& p, const Floats& slant,
                    float tolerance) {
  const Pixels pixels = PixelsOf(window, p);
  const Floats center = DepthsAt(window, pixels, 0);
  Floats off = Off(center, p.z);
  for (std::ptrdiff_t dy = -1; dy <= 1; ++dy) {
    for (std::ptrdiff_t dx = -1; dx <= 1; ++dx) {
      const Floats beside = Off(DepthsAt(window, pixels, dy * window.row + dx), p.z);
      off = Where(beside < off, beside) + Where(~(beside < off), off);
    }
  }
  Finding out;
  out.off = off * slant;
  out.there = out.off < All(tolerance);
  const Ints measured = center != All(0);
  out.hidden = ~out.there & (center < All(0)) & ((p.z + center) * slant > All(tolerance));
  out.denied = ~out.there & ~out.hidden & measured;
  out.unmeasured = ~out.there & ~measured;
  out.missing = window.alone ? out.unmeasured : Ints{};
  return out;
}

inline NormalEquations AccumulateEdges(const EdgeResiduals& in) {
  Equations sums;
  if (in.window.depth == nullptr) return {};
  const Floats per_reach = All(1 / (in.reach * in.reach));
  const Floats facing = All(in.min_facing * in.min_facing);
  const Floats3 center = All3(in.center);
  for (std::size_t i = 0; i < in.surface.points.count; i += kLanes) {
    const Floats3 place = Load3(in.surface.points, i);
    const Floats3 direction = Load3(in.surface.normals, i);
    const Floats3 seen = Point(in.sensor_surface, place);
    const Floats towards = -Dot(Direction(in.sensor_surface, direction), seen);
    const Floats squared = Dot(seen, seen);
    Ints used = (towards > All(0)) & (towards * towards >= facing * squared);
    if (!Any(used)) continue;
    const Floats3 q = Point(in.scan_surface, place);
    Ints known;
    const Ints at = NearestOf(in.scan, q, &known);
    used &= known;
    if (!Any(used)) continue;
    const Floats3 d = Minus(Gather3(in.scan.points, at), q);
    const Floats distance = Dot(d, d);
    const Floats rest = All(1) - distance * per_reach;
    used &= (distance >= All(in.spacing * in.spacing)) & (rest > All(0));
    if (!Any(used)) continue;
    const Floats3 normal = Direction(in.scan_surface, direction);
    used &= Dot(normal, Gather3(in.scan.normals, at)) >= All(in.min_agreement);
    if (!Any(used)) continue;
    const Floats slant = towards / Roots(squared);
    // Mostly the pixel itself shows the surface, and its neighbours need no check.
    const Floats shown = DepthsAt(in.window, PixelsOf(in.window, seen), 0);
    used &= Off(shown, seen.z) * slant >= All(in.spacing);
    if (!Any(used)) continue;
    const Finding finding = Find(in.window, seen, slant, in.spacing);
    used &= finding.denied | finding.missing;
    const Floats3 along = Minus(d, Times(normal, Dot(d, normal)));
    AddAlong(along, in.spacing, Minus(q, center), rest * rest, used, &sums);
  }
  return Added(sums);
}

inline Seen Look(const OrientedCoordinates& surface, const Rigid& sensor_surface,
                 const std::uint8_t* visible, const DepthWindow& window, float tolerance,
                 float missing_weight) {
  if (window.depth == nullptr) return {};
  Floats all = {};
  Floats expected = {};
  Floats found = {};
  Floats confirmed = {};
  Floats contradicted = {};
  Floats unmeasured = {};
  for (std::size_t i = 0; i < surface.points.count; i += kLanes) {
    Flags flags;
    std::memcpy(&flags, visible + i, sizeof(flags));
    const Ints looked_at = __builtin_convertvector(flags, Ints) != 0;
    if (!Any(looked_at)) continue;
    const Floats3 p = Point(sensor_surface, Load3(surface.points, i));
    const Floats3 normal = Direction(sensor_surface, Load3(surface.normals, i));
    const Floats slant = -Dot(normal, p) / Roots(Dot(p, p));
    const Floats area = Where(looked_at, slant);
    const Finding finding = Find(window, p, slant, tolerance);
    all += area;
    expected += Where(finding.there | finding.denied, area) +
                Where(finding.missing, area * All(missing_weight));
    const Floats share = finding.off / All(tolerance);
    found += Where(finding.there, area * (All(1) - share * share));
    confirmed += Where(finding.there, area);
    contradicted += Where(finding.denied, area);
    unmeasured += Where(finding.unmeasured, area);
  }
  return {Sum(all), Sum(expected), Sum(found), Sum(confirmed), Sum(contradicted), Sum(unmeasured)};
}

}  // namespace
}  // namespace graspdb::recognition::simd
