// PCD files and capture sets as text.
#pragma once

#include <Eigen/Core>
#include <string>

#include "recognition/base/types.h"

namespace graspdb::end_to_end {

// `count` points, 4 mm apart on a curved patch 0.6 m before the sensor.
recognition::Points CurvedPatch(int count);

// An ascii PCD file.
std::string AsciiPcd(const recognition::Points& points);

// The same with one normal for all.
std::string AsciiPcdWithNormals(const recognition::Points& points, const Eigen::Vector3f& normal);

// A captures.json with one object "o" in the stable pose "p" and one capture with the given fields
// and the path "cloud.pcd".
std::string CaptureSetJson(const std::string& capture_fields);

}  // namespace graspdb::end_to_end
