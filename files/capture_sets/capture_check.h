// Validation of capture sets.
#pragma once

#include <cstddef>
#include <string>

#include "absl/status/status.h"
#include "graspdb/v1/capture_set.pb.h"

namespace graspdb::files {

// INVALID_ARGUMENT with the place, as "captures[3].path …", when
// - an object, a stable pose or a grasp has no id or a duplicate one,
//   or a symmetry order below 0;
// - the region of interest is not finite or has a corner min above max;
// - a path is missing, absolute or outside the folder;
// - a capture names an object or a stable pose that `objects` does not declare,
//   or has the split TEACH without naming both;
// - a pose has a number that is not finite or a quaternion that is not of length
//   one (1e-3).
absl::Status CheckCaptureSet(const v1::CaptureSet& set);

// INVALID_ARGUMENT with the place when an object is more than 100 m from its sensor, usually
// because of millimetres. Not a rule of CheckCaptureSet, as what a server was taught is exported
// anyway.
absl::Status CheckDistances(const v1::CaptureSet& set);

// The rules of CheckCaptureSet for one declared stable pose, without its id; places begin with
// `field`.
absl::Status CheckStablePose(const v1::CapturedStablePose& pose, const std::string& field);

// The longest of a grasp's lengths and of its tool's distance from the object's origin, m: 20 or
// more are millimetres.
double LongestLengthOf(const v1::Grasp& grasp);

// Characters of an id, as the server limits them.
inline constexpr std::size_t kMaxIdLength = 63;

// INVALID_ARGUMENT, with the field, for an id that the server would reject: it is as one of an
// object. Capture sets may have others while nothing is taught with them.
absl::Status CheckId(const std::string& id, const std::string& field);

}  // namespace graspdb::files
