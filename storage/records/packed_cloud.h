// The stored form of a cloud: quantised, delta-coded, compressed, checksummed.
// docs/storage-format.md has the bytes. Pure functions; safe from any thread.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"

namespace graspdb::storage {

// x, y, z in metres, in the sensor frame.
using CloudPoint = std::array<float, 3>;

// Step of the quantisation, in metres; a coordinate moves by half of it at most.
inline constexpr double kCloudStep = 0.00005;
// Largest absolute coordinate that can be packed, in metres.
inline constexpr float kMaxCloudCoordinate = 100.0F;
// Largest number of points in a packed cloud.
inline constexpr std::size_t kMaxCloudPoints = 10'000'000;

// Packs `points`; keeps their order. INVALID_ARGUMENT when a coordinate is not
// finite or too large, or when there are too many points. The same points give
// the same bytes. `unpacked` (may be null) gets the points that UnpackCloud()
// returns for these bytes, some of them after an error.
absl::StatusOr<std::string> PackCloud(std::span<const CloudPoint> points,
                                      std::vector<CloudPoint>* unpacked = nullptr);

// The points of a packed cloud. Packing them again gives the same points. Safe for
// untrusted bytes: DATA_LOSS for any bytes that PackCloud did not write, and at most
// 250 MB are allocated.
absl::StatusOr<std::vector<CloudPoint>> UnpackCloud(std::string_view packed);

}  // namespace graspdb::storage
