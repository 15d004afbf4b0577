// Points sorted by a number, such as that of the cell or voxel that they are in.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "recognition/base/cancellation.h"
#include "recognition/base/grow.h"

namespace graspdb::recognition {

struct KeyedPoint {
  std::uint64_t key;
  std::int32_t point;  // position in its cloud
};

// Sorts by the keys, of which the largest is at most `largest`; equal ones stay in their order.
// Radix sort, O(n) for each 11 bits of `largest`; a pass over a million points takes about 10 ms.
// Once cancelled it returns, with the points in some other order.
inline void SortByKey(std::uint64_t largest, std::vector<KeyedPoint>* points,
                      const IsCancelled& is_cancelled) {
  constexpr int kBits = 11;
  constexpr std::size_t kBuckets = std::size_t{1} << kBits;
  CancellationPoll poll(is_cancelled);
  std::vector<KeyedPoint> other;
  if (!GrowTo(points->size(), &poll, &other)) return;
  for (int shift = 0; shift < 64 && (largest >> shift) > 0; shift += kBits) {
    if (poll.Now()) return;
    std::array<std::uint32_t, kBuckets> begin = {};
    const auto bucket = [&](const KeyedPoint& p) { return (p.key >> shift) % kBuckets; };
    for (const KeyedPoint& p : *points) ++begin[bucket(p)];
    if (poll.Now()) return;
    std::uint32_t sum = 0;
    for (std::uint32_t& count : begin) sum += std::exchange(count, sum);
    for (const KeyedPoint& p : *points) other[begin[bucket(p)]++] = p;
    points->swap(other);
  }
}

}  // namespace graspdb::recognition
