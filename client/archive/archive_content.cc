#include "client/archive/archive_content.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace graspdb::client {
namespace {

// m, and parts of a unit quaternion. Rounding changes 1e-16.
constexpr double kPoseTolerance = 1e-9;

bool IsNear(const v1::Pose& a, const v1::Pose& b) {
  const v1::Vector3& p = a.position();
  const v1::Vector3& q = b.position();
  const v1::Quaternion& r = a.orientation();
  const v1::Quaternion& s = b.orientation();
  const double cosine = r.x() * s.x() + r.y() * s.y() + r.z() * s.z() + r.w() * s.w();
  const double sign = cosine < 0 ? -1 : 1;  // both are the same rotation
  const std::array<double, 7> apart = {
      p.x() - q.x(),        p.y() - q.y(),        p.z() - q.z(),       r.x() - sign * s.x(),
      r.y() - sign * s.y(), r.z() - sign * s.z(), r.w() - sign * s.w()};
  // False for NaN.
  return std::ranges::all_of(apart, [](double d) { return std::abs(d) <= kPoseTolerance; });
}

absl::Time ToTime(const google::protobuf::Timestamp& time) {
  return absl::FromUnixSeconds(time.seconds()) + absl::Nanoseconds(time.nanos());
}

// Records without a release state are released.
template <typename Record>
void SetReleased(Record& record) {
  if (record.release() == v1::RELEASE_STATE_UNSPECIFIED) {
    record.set_release(v1::RELEASE_STATE_RELEASED);
  }
}

}  // namespace

v1::Object ContentOf(v1::Object object) {
  object.clear_name();
  object.clear_create_time();
  object.clear_update_time();
  object.clear_delete_time();
  object.clear_purge_time();
  object.clear_etag();
  SetReleased(object);
  return object;
}

v1::StablePose ContentOf(v1::StablePose pose) {
  pose.clear_name();
  pose.clear_create_time();
  pose.clear_update_time();
  pose.clear_etag();
  pose.clear_grasp_outcomes();
  SetReleased(pose);
  return pose;
}

bool IsSame(const v1::Object& a, const v1::Object& b) {
  return ContentOf(a).SerializeAsString() == ContentOf(b).SerializeAsString();
}

bool IsSame(const v1::StablePose& a, const v1::StablePose& b) {
  return ContentOf(a).SerializeAsString() == ContentOf(b).SerializeAsString();
}

bool MayBeSame(const v1::View& a, const v1::View& b) {
  return a.point_count() == b.point_count() &&
         a.object_pose_estimated() == b.object_pose_estimated() &&
         IsNear(a.object_pose(), b.object_pose()) && IsNear(a.sensor_pose(), b.sensor_pose());
}

bool IsSame(const v1::View& a, const v1::View& b) {
  return MayBeSame(a, b) && a.cloud().data() == b.cloud().data();
}

absl::Time ChangeTimeOf(const v1::Object& object) { return ToTime(object.update_time()); }
absl::Time ChangeTimeOf(const v1::StablePose& pose) { return ToTime(pose.update_time()); }
absl::Time ChangeTimeOf(const v1::View& view) { return ToTime(view.create_time()); }

}  // namespace graspdb::client
