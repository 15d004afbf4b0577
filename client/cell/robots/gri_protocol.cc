#include "client/cell/robots/gri_protocol.h"

#include <algorithm>

namespace graspdb::client {
namespace {

constexpr std::string_view kGriPrefix("GRI\0", 4);
constexpr std::size_t kVersionAt = 4;
constexpr std::size_t kLengthAt = 5;

bool MayBeGri(std::string_view received) {
  const std::size_t known = std::min(received.size(), kGriPrefix.size());
  return received.substr(0, known) == kGriPrefix.substr(0, known);
}

bool HasRequestLength(std::string_view received) {
  return static_cast<std::uint8_t>(received[kLengthAt]) == kGriRequestBytes;
}

RobotReply Encode(const GriResponse& response, bool hang_up) {
  const auto bytes = GriBytes(response);
  return {.bytes = std::string(bytes.begin(), bytes.end()), .hang_up = hang_up};
}

// The answer to an incomplete or invalid header.
RobotReply Refuse(std::string_view message) {
  GriResponse out;
  if (!MayBeGri(message) || message.size() < kGriHeaderBytes) {
    out.code = GriCode::kInvalidRequest;
    return Encode(out, /*hang_up=*/true);
  }
  out.pose_format = static_cast<std::uint8_t>(message[kLengthAt + 1]);
  out.action = static_cast<std::uint8_t>(message[kLengthAt + 2]);
  // The length field may have another meaning in other versions.
  const bool is_known = static_cast<std::uint8_t>(message[kVersionAt]) == kGriVersion;
  out.code = is_known ? GriCode::kInvalidRequestLength : GriCode::kUnknownProtocolVersion;
  return Encode(out, /*hang_up=*/true);
}

}  // namespace

std::size_t GriProtocol::MessageBytes(std::string_view received) const {
  if (!MayBeGri(received)) return received.size();
  if (received.size() < kGriHeaderBytes) return 0;
  if (!HasRequestLength(received)) return kGriHeaderBytes;
  return received.size() < kGriRequestBytes ? 0 : kGriRequestBytes;
}

GriResponse GriProtocol::Dispatch(const std::string& robot, const GriRequest& request) {
  switch (static_cast<GriAction>(request.action)) {
    case GriAction::kHecInit:
    case GriAction::kHecSetPose:
    case GriAction::kHecCalibrate:
      return hand_eye_.Answer(request);
    default:
      return jobs_.Answer(robot, request);
  }
}

RobotReply GriProtocol::Answer(const std::string& robot, std::string_view message) {
  if (message.size() != kGriRequestBytes) return Refuse(message);
  std::array<std::uint8_t, kGriRequestBytes> bytes = {};
  std::ranges::copy(message, bytes.begin());
  const absl::StatusOr<GriRequest> request = ParseGriRequest(bytes);
  if (!request.ok()) return Refuse(message);
  const GriCode fault = CheckGriRequest(*request);
  if (fault == GriCode::kNoError) return Encode(Dispatch(robot, *request), /*hang_up=*/false);
  GriResponse out = ResponseTo(*request);
  out.code = fault;
  return Encode(out, /*hang_up=*/false);
}

}  // namespace graspdb::client
