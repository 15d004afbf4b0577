#include "files/messages/cloud_message.h"

#include <openssl/sha.h>

#include <cstring>

#include "absl/strings/escaping.h"

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

}  // namespace graspdb::files
