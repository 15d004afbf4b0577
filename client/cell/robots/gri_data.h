// Positions in GriResponse::data, counted from 0; the interface's documentation counts from 1.
#pragma once

#include <cstddef>

namespace graspdb::client::gri_data {

inline constexpr std::size_t kReady = 1;        // of STATUS: 1 or 0
inline constexpr std::size_t kJobStatus = 1;    // of GET_JOB_STATUS: a GriJobStatus
inline constexpr std::size_t kPrimaryLeft = 1;  // of all actions that return a pose
inline constexpr std::size_t kRelatedLeft = 2;  // the same

// Of all actions that return a pose, an extension: the documented interface leaves them zero; see
// docs/gri.md.
inline constexpr std::size_t kGripperOpening = 3;    // millionths of a millimetre
inline constexpr std::size_t kApproachDistance = 4;  // the same
inline constexpr std::size_t kRetreatDistance = 5;   // the same
inline constexpr std::size_t kScore = 6;             // millionths
inline constexpr std::size_t kCameraTime = 7;        // microseconds

// Of HEC_CALIBRATE, also an extension.
inline constexpr std::size_t kShift = 1;  // millionths of a millimetre
inline constexpr std::size_t kTurn = 2;   // millionths of a degree
inline constexpr std::size_t kUsed = 3;   // number of poses that agree

}  // namespace graspdb::client::gri_data
