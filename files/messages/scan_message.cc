#include "files/messages/scan_message.h"

#include <openssl/sha.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "recognition/points/depth_image.h"

namespace graspdb::files {
namespace {

constexpr int kStride = 12;
static_assert(sizeof(Eigen::Vector3f) == kStride);
// Bytes of the digest in an id: enough for billions of captures.
constexpr std::size_t kIdBytes = 10;

std::string IdOf(const std::string& content) {
  unsigned char digest[SHA256_DIGEST_LENGTH];
  SHA256(reinterpret_cast<const unsigned char*>(content.data()), content.size(), digest);
  return absl::BytesToHexString(std::string(reinterpret_cast<const char*>(digest), kIdBytes));
}

}  // namespace

v1::PointCloud CloudMessage(const recognition::Points& points, int width) {
  v1::PointCloud out;
  out.set_point_stride(kStride);
  out.set_width(width);
  int offset = 0;
  for (const char* name : {"x", "y", "z"}) {
    v1::PackedElementField* field = out.add_fields();
    field->set_name(name);
    field->set_offset(offset);
    field->set_type(v1::PackedElementField::NUMERIC_TYPE_FLOAT32);
    offset += 4;
  }
  out.mutable_data()->assign(reinterpret_cast<const char*>(points.data()), points.size() * kStride);
  return out;
}

absl::StatusOr<recognition::Points> PointsFromMessage(const v1::PointCloud& cloud) {
  if (cloud.point_stride() != kStride || cloud.fields_size() != 3 ||
      cloud.data().size() % kStride != 0) {
    return absl::InvalidArgumentError("the cloud is not packed as x, y, z floats");
  }
  recognition::Points out(cloud.data().size() / kStride);
  std::memcpy(static_cast<void*>(out.data()), cloud.data().data(), cloud.data().size());
  return out;
}

std::string ContentId(const v1::View& view) {
  if (view.has_cloud()) return IdOf(view.cloud().data());
  v1::DepthImage image = view.depth_image();  // whose counts mean nothing without camera and unit
  image.clear_capture_time();
  return IdOf(image.SerializeAsString());
}

v1::CameraIntrinsics ToMessage(const recognition::CameraIntrinsics& camera) {
  v1::CameraIntrinsics out;
  out.set_width(camera.width);
  out.set_height(camera.height);
  out.set_fx(camera.fx);
  out.set_fy(camera.fy);
  out.set_cx(camera.cx);
  out.set_cy(camera.cy);
  return out;
}

recognition::CameraIntrinsics FromMessage(const v1::CameraIntrinsics& message) {
  return {.width = message.width(),
          .height = message.height(),
          .fx = message.fx(),
          .fy = message.fy(),
          .cx = message.cx(),
          .cy = message.cy()};
}

v1::DepthImage DepthMessage(const std::vector<std::uint16_t>& counts,
                            const recognition::CameraIntrinsics& camera, double unit_m) {
  v1::DepthImage out;
  *out.mutable_intrinsics() = ToMessage(camera);
  out.set_depth_unit_m(unit_m);
  std::string* bytes = out.mutable_data();
  bytes->reserve(2 * counts.size());
  for (const std::uint16_t count : counts) {
    bytes->push_back(static_cast<char>(count & 0xFFU));
    bytes->push_back(static_cast<char>(count >> 8U));
  }
  return out;
}

v1::DepthImage FineDepthMessage(std::span<const float> depths_m,
                                const recognition::CameraIntrinsics& camera, double far_m) {
  constexpr long kMaxCount = kNoCount - 1;
  const double unit_m = far_m / kMaxCount;
  std::vector<std::uint16_t> counts;
  counts.reserve(depths_m.size());
  for (const float depth : depths_m) {
    const long count = depth > 0 ? std::lround(static_cast<double>(depth) / unit_m) : 0;
    counts.push_back(count <= kMaxCount ? static_cast<std::uint16_t>(count) : 0);
  }
  return DepthMessage(counts, camera, unit_m);
}

absl::StatusOr<std::vector<std::uint16_t>> CountsFromMessage(const v1::DepthImage& image) {
  const v1::CameraIntrinsics& camera = image.intrinsics();
  const std::int64_t pixels = std::int64_t{camera.width()} * camera.height();
  const std::string& bytes = image.data();
  if (camera.width() < 1 || camera.height() < 1 ||
      static_cast<std::int64_t>(bytes.size()) != 2 * pixels) {
    return absl::InvalidArgumentError(absl::StrCat("a depth image of ", camera.width(), " x ",
                                                   camera.height(), " pixels has ", bytes.size(),
                                                   " bytes; two per pixel are expected"));
  }
  std::vector<std::uint16_t> counts;
  counts.reserve(static_cast<std::size_t>(pixels));
  for (std::size_t i = 0; i < bytes.size(); i += 2) {
    const auto low = static_cast<unsigned char>(bytes[i]);
    const auto high = static_cast<unsigned char>(bytes[i + 1]);
    counts.push_back(static_cast<std::uint16_t>(low | high << 8U));
  }
  return counts;
}

absl::StatusOr<recognition::Points> PointsFromMessage(const v1::DepthImage& message) {
  recognition::DepthImage image{
      .depth = {}, .camera = FromMessage(message.intrinsics()), .unit_m = DepthUnit(message)};
  ASSIGN_OR_RETURN(std::vector<std::uint16_t> counts, CountsFromMessage(message));
  if (!(image.camera.fx > 0 && image.camera.fy > 0)) {
    return absl::InvalidArgumentError(absl::StrCat("the focal lengths of the depth image are ",
                                                   image.camera.fx, " and ", image.camera.fy,
                                                   " pixels; check the camera"));
  }
  image.depth = std::move(counts);
  std::ranges::replace(image.depth, kNoCount, std::uint16_t{0});
  return recognition::PointsOf(image);
}

double DepthUnit(const v1::DepthImage& image) {
  return image.depth_unit_m() == 0 ? 0.001 : image.depth_unit_m();
}

}  // namespace graspdb::files
