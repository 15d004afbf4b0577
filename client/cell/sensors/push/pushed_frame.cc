#include "client/cell/sensors/push/pushed_frame.h"

#include <cstdint>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "files/messages/cloud_message.h"
#include "files/messages/depth_message.h"
#include "files/messages/read_scan.h"

namespace graspdb::client {
namespace {

// Bytes of a point: with fewer its floats overlap, and the repacked cloud is larger than the
// request.
constexpr int kMinStride = 12;
constexpr int kMaxFields = 64;

absl::Status Wrong(std::string_view field, std::string_view what) {
  return absl::InvalidArgumentError(absl::StrCat(std::string(field), " ", std::string(what)));
}

constexpr files::ScanRules kRules{.wrong = &Wrong, .min_stride = kMinStride, .allows_blank = true};

absl::StatusOr<files::ScanMessage> CheckedImage(const v1::DepthImage& image) {
  recognition::Scan scan;
  RETURN_IF_ERROR(files::ReadScan(image, kRules, "depth_image", &scan));
  const recognition::DepthImage& read = scan.depth_image;
  return files::DepthMessage(read.depth, read.camera, read.unit_m);
}

absl::StatusOr<files::ScanMessage> CheckedCloud(const v1::PointCloud& cloud) {
  if (cloud.fields_size() > kMaxFields) return Wrong("cloud.fields", "are more than 64");
  recognition::Scan scan;
  RETURN_IF_ERROR(files::ReadScan(cloud, kRules, "cloud", &scan));
  const std::size_t count = scan.points.size();
  if (scan.width < 0 || (scan.width > 0 && count % static_cast<std::size_t>(scan.width) != 0)) {
    return Wrong("cloud.width", absl::StrCat("is ", scan.width, ", and ", count,
                                             " points are no rows of it; 0: not organised"));
  }
  return files::CloudMessage(scan.points, scan.width);
}

// How old the scan is.
absl::StatusOr<absl::Duration> AgeOf(const google::protobuf::Timestamp& stamp, absl::Time arrival) {
  // Years 1 to 9999, as documented for Timestamp.
  constexpr std::int64_t kFirst = -62'135'596'800;
  constexpr std::int64_t kLast = 253'402'300'799;
  if (stamp.seconds() < kFirst || stamp.seconds() > kLast || stamp.nanos() < 0 ||
      stamp.nanos() >= 1'000'000'000) {
    return Wrong("capture_time", "is no time");
  }
  const absl::Duration age =
      arrival - absl::FromUnixSeconds(stamp.seconds()) - absl::Nanoseconds(stamp.nanos());
  if (age < absl::ZeroDuration()) {
    return Wrong("capture_time", absl::StrCat("is ", absl::FormatDuration(-age),
                                              " in the future; set the clock of this machine"));
  }
  if (age > kMaxPushedAge) {
    return Wrong(
        "capture_time",
        absl::StrCat("is ", absl::FormatDuration(age),
                     " ago; send frames at once, and compare the clocks of both machines"));
  }
  return age;
}

}  // namespace

absl::StatusOr<SensorFrame> PushedFrame(const v1::PushFrameRequest& request, absl::Time arrival,
                                        MonotonicTime now) {
  if (request.camera().empty() || request.camera().size() > kMaxCameraNameBytes) {
    return Wrong("camera", "must have 1 to 256 bytes, such as the serial number of the camera");
  }
  const bool is_image = request.has_depth_image();
  if (!is_image && !request.has_cloud()) {
    return Wrong("scan", "is missing: give a cloud or a depth_image");
  }
  const bool has_time =
      is_image ? request.depth_image().has_capture_time() : request.cloud().has_capture_time();
  if (!has_time) return Wrong("capture_time", "is missing; set it to the start of the exposure");
  ASSIGN_OR_RETURN(const absl::Duration age, AgeOf(is_image ? request.depth_image().capture_time()
                                                            : request.cloud().capture_time(),
                                                   arrival));
  ASSIGN_OR_RETURN(files::ScanMessage scan,
                   is_image ? CheckedImage(request.depth_image()) : CheckedCloud(request.cloud()));
  SensorFrame frame = {.scan = std::move(scan)};
  SetTime(now - age, frame);
  return frame;
}

}  // namespace graspdb::client
