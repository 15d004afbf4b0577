// Where the points of a scan are, for people.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "recognition/points/scan.h"

namespace graspdb::recognition {

// The median of each coordinate of the measured points, sensor frame, m; of some thousand of them
// where there are more. nullopt without a measurement. O(n).
std::optional<Eigen::Vector3f> MedianPoint(const Scan& scan);

// Whether a depth camera can have it as the middle of its points: in front of it, and neither
// nearer nor farther than a table is.
bool IsUsualDistance(const Eigen::Vector3f& median);

// "the middle of its points is 5.03 m in front of the sensor", and what may be wrong where that is
// unusual; with `world_sensor` also where that is in the world frame.
std::string WhereMedianIs(const Eigen::Vector3f& median, const std::optional<Pose>& world_sensor);

// "; " and that for the end of an error about the scan; empty without a measurement.
std::string AndWhereMedianIs(const Scan& scan, const std::optional<Pose>& world_sensor);

}  // namespace graspdb::recognition
