// The messages of the Generic Robot Interface, version 1: a robot asks in 54 bytes and is answered
// in 80, all numbers little-endian.
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
  std::uint8_t length = kGriRequestBytes;  // as the message says of itself
  std::uint8_t pose_format = kQuaternionWxyz;
  std::uint8_t action = 0;  // a GriAction, or nothing known
  std::uint16_t job_id = 0;
  GriPose pose;  // where the robot is
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

// An answer to `request` that says nothing yet.
GriResponse ResponseTo(const GriRequest& request);

// A number as the messages have it. Numbers that do not fit are the nearest that do; no number is
// the largest.
std::int32_t Saturated(double number);

// INVALID_ARGUMENT when the magic bytes are not there: then nobody knows where the next message
// begins, and the connection is to be closed.
absl::StatusOr<GriRequest> ParseGriRequest(std::span<const std::uint8_t, kGriRequestBytes> bytes);

// INVALID_ARGUMENT when the magic bytes are not there, and when version or length is another.
absl::StatusOr<GriResponse> ParseGriResponse(
    std::span<const std::uint8_t, kGriResponseBytes> bytes);

std::array<std::uint8_t, kGriRequestBytes> GriBytes(const GriRequest& request);
std::array<std::uint8_t, kGriResponseBytes> GriBytes(const GriResponse& response);

// What is wrong with the header of a request, kNoError where nothing is.
GriCode CheckGriRequest(const GriRequest& request);

// A pose (metres, any frame) in the pose format of this code, and back. OUT_OF_RANGE when a number
// does not fit: positions reach to 2147.48 mm. Otherwise errors as ToRobotPose and FromRobotPose.
absl::StatusOr<GriPose> ToGriPose(const recognition::Pose& pose, int format);
absl::StatusOr<recognition::Pose> FromGriPose(const GriPose& pose, int format);

}  // namespace graspdb::client
