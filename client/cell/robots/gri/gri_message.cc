#include "client/cell/robots/gri/gri_message.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"

namespace graspdb::client {
namespace {

constexpr std::array<std::uint8_t, 4> kGriMagic = {'G', 'R', 'I', 0};
constexpr double kPerUnit = 1e6;

// Reads numbers one after the other.
class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  template <typename... T>
  void Read(T*... values) {
    (ReadOne(values), ...);
  }

 private:
  template <typename T>
  void ReadOne(T* value) {
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      bits |= static_cast<std::uint64_t>(bytes_[at_++]) << (8 * i);
    }
    *value = static_cast<T>(bits);
  }

  template <typename T, std::size_t kCount>
  void ReadOne(std::array<T, kCount>* values) {
    for (T& value : *values) ReadOne(&value);
  }

  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
};

class Writer {
 public:
  explicit Writer(std::span<std::uint8_t> bytes) : bytes_(bytes) {}

  template <typename... T>
  void Write(const T&... values) {
    (WriteOne(values), ...);
  }

 private:
  template <typename T>
  void WriteOne(T value) {
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      bytes_[at_++] = static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i));
    }
  }

  template <typename T, std::size_t kCount>
  void WriteOne(const std::array<T, kCount>& values) {
    for (const T value : values) WriteOne(value);
  }

  std::span<std::uint8_t> bytes_;
  std::size_t at_ = 0;
};

absl::Status CheckMagic(const std::array<std::uint8_t, 4>& magic) {
  if (magic == kGriMagic) return absl::OkStatus();
  return absl::InvalidArgumentError("the message does not begin with \"GRI\"");
}

absl::StatusOr<std::int32_t> CheckedMillionths(double number) {
  const double scaled = std::round(number * kPerUnit);
  if (std::abs(scaled) <= std::numeric_limits<std::int32_t>::max()) {
    return static_cast<std::int32_t>(scaled);
  }
  return absl::OutOfRangeError(
      absl::StrCat(number, " does not fit into the message, which reaches to 2147.48"));
}

template <std::size_t kCount>
absl::Status ToMillionths(const std::array<double, kCount>& numbers,
                          std::array<std::int32_t, kCount>* out) {
  for (std::size_t i = 0; i < kCount; ++i) {
    ASSIGN_OR_RETURN(const std::int32_t number, CheckedMillionths(numbers[i]));
    (*out)[i] = number;
  }
  return absl::OkStatus();
}

}  // namespace

GriResponse ResponseTo(const GriRequest& request) {
  GriResponse out;
  out.pose_format = request.pose_format;
  out.action = request.action;
  out.job_id = request.job_id;
  return out;
}

std::int32_t Saturated(double number) {
  using Limits = std::numeric_limits<std::int32_t>;
  if (std::isnan(number)) return Limits::max();
  const double fitting = std::clamp<double>(number, Limits::min(), Limits::max());
  return static_cast<std::int32_t>(std::lround(fitting));
}

absl::StatusOr<GriRequest> ParseGriRequest(std::span<const std::uint8_t, kGriRequestBytes> bytes) {
  Reader reader(bytes);
  std::array<std::uint8_t, 4> magic = {};
  reader.Read(&magic);
  RETURN_IF_ERROR(CheckMagic(magic));
  GriRequest out;
  reader.Read(&out.version, &out.length, &out.pose_format, &out.action, &out.job_id,
              &out.pose.position, &out.pose.rotation, &out.data);
  return out;
}

absl::StatusOr<GriResponse> ParseGriResponse(
    std::span<const std::uint8_t, kGriResponseBytes> bytes) {
  Reader reader(bytes);
  std::array<std::uint8_t, 4> magic = {};
  reader.Read(&magic);
  RETURN_IF_ERROR(CheckMagic(magic));
  std::uint8_t version = 0;
  std::uint8_t length = 0;
  reader.Read(&version, &length);
  if (version != kGriVersion || length != kGriResponseBytes) {
    return absl::InvalidArgumentError("the answer is of another version or length");
  }
  GriResponse out;
  std::int16_t code = 0;
  reader.Read(&out.pose_format, &out.action, &out.job_id, &code, &out.pose.position,
              &out.pose.rotation, &out.data);
  out.code = static_cast<GriCode>(code);
  return out;
}

std::array<std::uint8_t, kGriRequestBytes> GriBytes(const GriRequest& request) {
  std::array<std::uint8_t, kGriRequestBytes> out = {};
  Writer(out).Write(kGriMagic, request.version, request.length, request.pose_format, request.action,
                    request.job_id, request.pose.position, request.pose.rotation, request.data);
  return out;
}

std::array<std::uint8_t, kGriResponseBytes> GriBytes(const GriResponse& response) {
  std::array<std::uint8_t, kGriResponseBytes> out = {};
  Writer(out).Write(kGriMagic, kGriVersion, static_cast<std::uint8_t>(kGriResponseBytes),
                    response.pose_format, response.action, response.job_id,
                    static_cast<std::int16_t>(response.code), response.pose.position,
                    response.pose.rotation, response.data);
  return out;
}

GriCode CheckGriRequest(const GriRequest& request) {
  if (request.version != kGriVersion) return GriCode::kUnknownProtocolVersion;
  if (request.length != kGriRequestBytes) return GriCode::kInvalidRequestLength;
  if (request.pose_format < kQuaternionWxyz || request.pose_format > kLastPoseFormat) {
    return GriCode::kInvalidRequest;
  }
  if (request.action < static_cast<std::uint8_t>(GriAction::kStatus) ||
      request.action > static_cast<std::uint8_t>(GriAction::kHecCalibrate)) {
    return GriCode::kInvalidAction;
  }
  return GriCode::kNoError;
}

absl::StatusOr<GriPose> ToGriPose(const recognition::Pose& pose, int format) {
  ASSIGN_OR_RETURN(const RobotPose numbers, ToRobotPose(pose, format));
  GriPose out;
  RETURN_IF_ERROR(ToMillionths(numbers.position_mm, &out.position));
  RETURN_IF_ERROR(ToMillionths(numbers.rotation, &out.rotation));
  return out;
}

absl::StatusOr<recognition::Pose> FromGriPose(const GriPose& pose, int format) {
  RobotPose numbers;
  const auto to_units = [](std::int32_t millionths) { return millionths / kPerUnit; };
  std::ranges::transform(pose.position, numbers.position_mm.begin(), to_units);
  std::ranges::transform(pose.rotation, numbers.rotation.begin(), to_units);
  return FromRobotPose(numbers, format);
}

bool HasRobotPose(const GriRequest& request) {
  const auto is_set = [](std::int32_t number) { return number != 0; };
  return std::ranges::any_of(request.pose.position, is_set) ||
         std::ranges::any_of(request.pose.rotation, is_set);
}

absl::StatusOr<recognition::Pose> RobotPoseOf(const GriRequest& request) {
  if (!HasRobotPose(request)) {
    return absl::InvalidArgumentError("the request has no pose of the robot; send it");
  }
  return FromGriPose(request.pose, request.pose_format);
}

}  // namespace graspdb::client
