// Vectors of eight numbers, for the bodies of kernels. Everything here is local to the file that
// includes it: see kernel_bodies.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "recognition/simd/kernels.h"

namespace graspdb::recognition::simd {
namespace {

// Eight numbers; gcc and clang compile them for the processor.
using Floats [[gnu::vector_size(32)]] = float;
using Ints [[gnu::vector_size(32)]] = std::int32_t;
using Counts [[gnu::vector_size(16)]] = std::uint16_t;
using Flags [[gnu::vector_size(8)]] = std::uint8_t;

inline Floats Load(const float* at) {
  Floats out;
  std::memcpy(&out, at, sizeof(out));
  return out;
}

inline Floats All(float value) {
  return Floats{value, value, value, value, value, value, value, value};
}

// The value where the mask is set, else 0.
inline Floats Where(const Ints& mask, const Floats& value) { return (Floats)((Ints)value & mask); }

inline float Sum(const Floats& v) {
  return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
}

inline std::size_t Sum(const Ints& v) {
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < kLanes; ++i) sum += v[i];
  return static_cast<std::size_t>(sum);
}

inline Floats Roots(const Floats& v) {
  Floats out;
  for (std::size_t i = 0; i < kLanes; ++i) out[i] = __builtin_sqrtf(v[i]);
  return out;
}

inline bool Any(const Ints& mask) {
  std::uint64_t parts[4];
  std::memcpy(parts, &mask, sizeof(parts));
  return ((parts[0] | parts[1]) | (parts[2] | parts[3])) != 0;
}

// 1 where the mask is set. In two steps: at once gcc moves byte by byte.
inline Flags FlagsOf(const Ints& mask) {
  using Halves [[gnu::vector_size(16)]] = std::int16_t;
  return __builtin_convertvector(__builtin_convertvector(-mask, Halves), Flags);
}

// The larger of a value and zero.
inline Floats Positive(const Floats& v) { return Where(v > All(0), v); }

inline Floats Absolute(const Floats& v) { return Positive(v) + Positive(-v); }

// Three coordinates of eight points.
struct Floats3 {
  Floats x;
  Floats y;
  Floats z;
};

inline Floats3 Load3(const Coordinates& from, std::size_t i) {
  return {Load(from.x + i), Load(from.y + i), Load(from.z + i)};
}

inline Floats3 All3(const float* v) { return {All(v[0]), All(v[1]), All(v[2])}; }

inline Floats3 Minus(const Floats3& a, const Floats3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

inline Floats3 Times(const Floats3& a, const Floats& b) { return {a.x * b, a.y * b, a.z * b}; }

inline Floats Dot(const Floats3& a, const Floats3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

inline Floats3 Cross(const Floats3& a, const Floats3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

inline Floats RowTimes(const float* row, const Floats3& v) {
  return All(row[0]) * v.x + All(row[1]) * v.y + All(row[2]) * v.z;
}

inline Floats3 Direction(const Rigid& m, const Floats3& v) {
  return {RowTimes(m.rotation[0], v), RowTimes(m.rotation[1], v), RowTimes(m.rotation[2], v)};
}

inline Floats3 Point(const Rigid& m, const Floats3& p) {
  const Floats3 turned = Direction(m, p);
  return {turned.x + All(m.translation[0]), turned.y + All(m.translation[1]),
          turned.z + All(m.translation[2])};
}

// Rows of three floats.
inline Floats3 Gather3(const float* rows, const Ints& index) {
  Floats3 out;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const float* row = rows + std::ptrdiff_t{3} * index[i];
    out.x[i] = row[0];
    out.y[i] = row[1];
    out.z[i] = row[2];
  }
  return out;
}

}  // namespace
}  // namespace graspdb::recognition::simd
