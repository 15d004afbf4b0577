#include "client/cell/sensors/push/pushed_frame.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "files/messages/cloud_message.h"
#include "files/messages/depth_message.h"

namespace graspdb::client {
namespace {

using Field = v1::PackedElementField;
static_assert(std::endian::native == std::endian::little, "packed data is little-endian");

// Bytes of a point: with fewer its floats overlap, and the repacked cloud is larger than the
// request.
constexpr int kMinStride = 12;
constexpr int kMaxStride = 4096;
constexpr int kMaxFields = 64;
// As the server checks it: a median distance beyond this, m, means another unit.
constexpr double kMaxMedianDistance = 50;
// Number of distances for that check.
constexpr std::size_t kUnitSampleSize = 1000;

absl::Status Wrong(const std::string& field, const std::string& what) {
  return absl::InvalidArgumentError(absl::StrCat(field, " ", what));
}

// The median of a sample of all measured distances, `distance_at` of 0 to count - 1; NaN and 0 are
// not measured.
template <typename Distance>
absl::Status CheckUnit(std::size_t count, const std::string& field, Distance distance_at) {
  const std::size_t step = std::max<std::size_t>(1, count / kUnitSampleSize);
  std::vector<double> sample;
  sample.reserve(count / step + 1);
  for (std::size_t i = 0; i < count; i += step) {
    const double distance = distance_at(i);
    if (std::isfinite(distance) && distance > 0) sample.push_back(distance);
  }
  if (sample.empty()) return absl::OkStatus();
  const auto middle = sample.begin() + static_cast<std::ptrdiff_t>(sample.size() / 2);
  std::nth_element(sample.begin(), middle, sample.end());
  if (*middle <= kMaxMedianDistance) return absl::OkStatus();
  return Wrong(field, absl::StrCat("has a median distance of ", *middle,
                                   " m; distances are in metres, are these millimetres?"));
}

absl::Status CheckCamera(const v1::CameraIntrinsics& camera) {
  constexpr char kField[] = "depth_image.intrinsics";
  if (camera.width() < 1 || camera.height() < 1) return Wrong(kField, "have no width or height");
  const std::array<double, 4> values = {camera.fx(), camera.fy(), camera.cx(), camera.cy()};
  const bool finite = std::ranges::all_of(values, [](double v) { return std::isfinite(v); });
  if (finite && camera.fx() > 0 && camera.fy() > 0) return absl::OkStatus();
  return Wrong(kField, "must have finite values and positive focal lengths, in pixels");
}

absl::StatusOr<files::ScanMessage> CheckedImage(const v1::DepthImage& image) {
  RETURN_IF_ERROR(CheckCamera(image.intrinsics()));
  const double unit = files::DepthUnit(image);
  if (!(unit > 0 && unit <= 0.1)) return Wrong("depth_image.depth_unit_m", "is not in 0 to 0.1 m");
  const std::int64_t pixels =
      std::int64_t{image.intrinsics().width()} * image.intrinsics().height();
  const std::string& data = image.data();
  if (static_cast<std::int64_t>(data.size()) != 2 * pixels) {
    return Wrong("depth_image.data", absl::StrCat("has ", data.size(), " bytes; ", pixels,
                                                  " pixels have ", 2 * pixels));
  }
  RETURN_IF_ERROR(CheckUnit(data.size() / 2, "depth_image", [&](std::size_t i) {
    std::uint16_t count = 0;
    std::memcpy(&count, data.data() + 2 * i, sizeof(count));
    return count == files::kNoCount ? 0 : count * unit;
  }));
  v1::DepthImage out;
  *out.mutable_intrinsics() = files::ToMessage(files::FromMessage(image.intrinsics()));
  out.set_depth_unit_m(image.depth_unit_m());
  out.set_data(data);
  return out;
}

std::size_t SizeOf(Field::NumericType type) {
  switch (type) {
    case Field::NUMERIC_TYPE_FLOAT32:
      return sizeof(float);
    case Field::NUMERIC_TYPE_FLOAT64:
      return sizeof(double);
    default:
      return 0;
  }
}

// The field of the given name, which ends within the stride.
absl::StatusOr<Field> FieldNamed(const v1::PointCloud& cloud, const std::string& name) {
  for (const Field& field : cloud.fields()) {
    if (field.name() != name) continue;
    const auto size = static_cast<std::int64_t>(SizeOf(field.type()));
    if (size == 0) return Wrong("cloud.fields", absl::StrCat("give ", name, " no float type"));
    if (field.offset() < 0 || field.offset() + size > cloud.point_stride()) {
      return Wrong("cloud.fields", absl::StrCat("place ", name, " outside of the stride of ",
                                                cloud.point_stride(), " bytes"));
    }
    return field;
  }
  return Wrong("cloud.fields", absl::StrCat("have no \"", name, "\"; x, y and z are required"));
}

float NumberAt(const char* at, Field::NumericType type) {
  if (type == Field::NUMERIC_TYPE_FLOAT32) {
    float value = 0;
    std::memcpy(&value, at, sizeof(value));
    return value;
  }
  double value = 0;
  std::memcpy(&value, at, sizeof(value));
  return static_cast<float>(value);
}

absl::Status CheckLayout(const v1::PointCloud& cloud) {
  const int stride = cloud.point_stride();
  if (stride < kMinStride || stride > kMaxStride) {
    return Wrong("cloud.point_stride", absl::StrCat("is ", stride, "; points have ", kMinStride,
                                                    " to ", kMaxStride, " bytes"));
  }
  if (cloud.fields_size() > kMaxFields) return Wrong("cloud.fields", "are more than 64");
  const std::size_t size = cloud.data().size();
  if (size == 0 || size % static_cast<std::size_t>(stride) != 0) {
    return Wrong("cloud.data",
                 absl::StrCat("has ", size, " bytes, which is no positive multiple of the stride"));
  }
  const std::size_t count = size / static_cast<std::size_t>(stride);
  if (cloud.width() < 0 ||
      (cloud.width() > 0 && count % static_cast<std::size_t>(cloud.width()) != 0)) {
    return Wrong("cloud.width", absl::StrCat("is ", cloud.width(), ", and ", count,
                                             " points are no rows of it; 0: not organised"));
  }
  return absl::OkStatus();
}

absl::StatusOr<files::ScanMessage> CheckedCloud(const v1::PointCloud& cloud) {
  RETURN_IF_ERROR(CheckLayout(cloud));
  ASSIGN_OR_RETURN(const Field x, FieldNamed(cloud, "x"));
  ASSIGN_OR_RETURN(const Field y, FieldNamed(cloud, "y"));
  ASSIGN_OR_RETURN(const Field z, FieldNamed(cloud, "z"));
  const auto stride = static_cast<std::size_t>(cloud.point_stride());
  recognition::Points points(cloud.data().size() / stride);
  const char* at = cloud.data().data();
  for (Eigen::Vector3f& point : points) {
    point = {NumberAt(at + x.offset(), x.type()), NumberAt(at + y.offset(), y.type()),
             NumberAt(at + z.offset(), z.type())};
    at += stride;
  }
  RETURN_IF_ERROR(CheckUnit(points.size(), "cloud", [&points](std::size_t i) {
    return points[i].cast<double>().stableNorm();
  }));
  return files::CloudMessage(points, cloud.width());
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
