#include "client/cell/robots/gri/gri_protocol.h"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "program/log/log_field.h"

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

std::string WrongVersion(int version) {
  return absl::StrCat("the message is of version ", version, "; send ", int{kGriVersion});
}

std::string WrongLength(int length) {
  return absl::StrCat("the message gives ", length, " as its length; send ", kGriRequestBytes);
}

// What is wrong with the header of a request.
std::string ReasonOf(GriCode fault, const GriRequest& request) {
  switch (fault) {
    case GriCode::kUnknownProtocolVersion:
      return WrongVersion(request.version);
    case GriCode::kInvalidRequest:
      return absl::StrCat("there is no pose format ", int{request.pose_format}, "; send ",
                          kQuaternionWxyz, " to ", kLastPoseFormat);
    case GriCode::kInvalidAction:
      return absl::StrCat("there is no action ", int{request.action}, "; send 1 to 9");
    default:
      return WrongLength(request.length);
  }
}

// A robot gets the number only, so that the log has the reason.
void LogInvalid(const std::string& robot, GriCode code, const std::string& reason) {
  spdlog::warn("event=request_refused robot={} code={} error={}", LogField(robot),
               GriCodeName(code), LogField(reason));
}

// The answer to an incomplete or invalid header.
RobotReply Refuse(const std::string& robot, std::string_view message) {
  GriResponse out;
  if (!MayBeGri(message) || message.size() < kGriHeaderBytes) {
    out.code = GriCode::kInvalidRequest;
    LogInvalid(robot, out.code, "the message does not begin with \"GRI\" and a zero byte");
    return Encode(out, /*hang_up=*/true);
  }
  out.pose_format = static_cast<std::uint8_t>(message[kLengthAt + 1]);
  out.action = static_cast<std::uint8_t>(message[kLengthAt + 2]);
  // The length field may have another meaning in other versions.
  const auto version = static_cast<std::uint8_t>(message[kVersionAt]);
  const bool is_known = version == kGriVersion;
  out.code = is_known ? GriCode::kInvalidRequestLength : GriCode::kUnknownProtocolVersion;
  LogInvalid(robot, out.code,
             is_known ? WrongLength(static_cast<std::uint8_t>(message[kLengthAt]))
                      : WrongVersion(version));
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
  if (message.size() != kGriRequestBytes) return Refuse(robot, message);
  std::array<std::uint8_t, kGriRequestBytes> bytes = {};
  std::ranges::copy(message, bytes.begin());
  const absl::StatusOr<GriRequest> request = ParseGriRequest(bytes);
  if (!request.ok()) return Refuse(robot, message);
  const GriCode fault = CheckGriRequest(*request);
  if (fault == GriCode::kNoError) return Encode(Dispatch(robot, *request), /*hang_up=*/false);
  LogInvalid(robot, fault, ReasonOf(fault, *request));
  GriResponse out = ResponseTo(*request);
  out.code = fault;
  return Encode(out, /*hang_up=*/false);
}

}  // namespace graspdb::client
