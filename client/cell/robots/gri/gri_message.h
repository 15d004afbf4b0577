// The messages of the Generic Robot Interface, version 1: requests of 54 bytes and responses of 80,
// all numbers little-endian.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "absl/status/statusor.h"
#include "client/cell/robots/gri_code.h"
#include "client/cell/robots/pose_format.h"

namespace graspdb::client {

inline constexpr std::uint8_t kGriVersion = 1;
inline constexpr std::size_t kGriHeaderBytes = 8;
inline constexpr std::size_t kGriRequestBytes = 54;
inline constexpr std::size_t kGriResponseBytes = 80;

enum class GriAction : std::uint8_t {
  kStatus = 1,
  kTriggerJobSync = 2,
  kTriggerJobAsync = 3,
  kGetJobStatus = 4,
  kGetNextPose = 5,
  kGetRelatedPose = 6,
  kHecInit = 7,
  kHecSetPose = 8,
  kHecCalibrate = 9,
};

// A pose as it is sent: millionths of a millimetre, and of the format's unit.
struct GriPose {
  std::array<std::int32_t, 3> position = {};
  std::array<std::int32_t, 4> rotation = {};
};

struct GriRequest {
  std::uint8_t version = kGriVersion;
  std::uint8_t length = kGriRequestBytes;  // as given in the message
  std::uint8_t pose_format = kQuaternionWxyz;
  std::uint8_t action = 0;  // a GriAction, or unknown
  std::uint16_t job_id = 0;
  GriPose pose;  // of the robot
  std::array<std::int32_t, 4> data = {};
};

struct GriResponse {
  std::uint8_t pose_format = kQuaternionWxyz;
  std::uint8_t action = 0;
  std::uint16_t job_id = 0;
  GriCode code = GriCode::kNoError;
  GriPose pose;
  std::array<std::int32_t, 10> data = {};
};

// An empty response to `request`.
GriResponse ResponseTo(const GriRequest& request);

// Rounded, and clamped to the range of the messages' numbers; the largest for NaN.
std::int32_t Saturated(double number);

// INVALID_ARGUMENT without the magic bytes: then the start of the next message is unknown, and the
// connection must be closed.
absl::StatusOr<GriRequest> ParseGriRequest(std::span<const std::uint8_t, kGriRequestBytes> bytes);

// INVALID_ARGUMENT without the magic bytes, and for another version or length.
absl::StatusOr<GriResponse> ParseGriResponse(
    std::span<const std::uint8_t, kGriResponseBytes> bytes);

std::array<std::uint8_t, kGriRequestBytes> GriBytes(const GriRequest& request);
std::array<std::uint8_t, kGriResponseBytes> GriBytes(const GriResponse& response);

// The error in the header of a request, or kNoError.
GriCode CheckGriRequest(const GriRequest& request);

// Converts a pose (metres, any frame) to the pose format `format` and back. OUT_OF_RANGE when a
// number does not fit: positions reach to 2147.48 mm. Also errors of ToRobotPose and FromRobotPose.
absl::StatusOr<GriPose> ToGriPose(const recognition::Pose& pose, int format);
absl::StatusOr<recognition::Pose> FromGriPose(const GriPose& pose, int format);

// Whether a request has a pose of the robot, see RobotPoseOf.
bool HasRobotPose(const GriRequest& request);

// The robot's own pose in a request. INVALID_ARGUMENT as FromGriPose, and when all numbers are
// zero: so programs leave it out, and no flange is in the origin of its base.
absl::StatusOr<recognition::Pose> RobotPoseOf(const GriRequest& request);

// Positions in GriResponse::data, counted from 0; the interface's documentation counts from 1.
namespace gri_data {

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

}  // namespace gri_data

}  // namespace graspdb::client
