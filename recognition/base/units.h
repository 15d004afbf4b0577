// Units for people and robots; everything else is in metres and radians.
#pragma once

#include <numbers>

namespace graspdb::recognition {

inline constexpr double kMmPerM = 1000;
inline constexpr double kDegreesPerRadian = 180 / std::numbers::pi;
inline constexpr double kRadiansPerDegree = std::numbers::pi / 180;

}  // namespace graspdb::recognition
