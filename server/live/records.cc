#include "server/live/records.h"

#include <algorithm>
#include <span>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "recognition/segmentation/segmentation.h"
#include "server/requests/convert.h"
#include "storage/base/restore_advice.h"
#include "storage/records/packed_cloud.h"
#include "storage/records/resource_name.h"

namespace graspdb::server {
namespace {

recognition::Points PointsOf(std::span<const storage::CloudPoint> unpacked) {
  recognition::Points points;
  points.reserve(unpacked.size());
  for (const storage::CloudPoint& p : unpacked) points.emplace_back(p[0], p[1], p[2]);
  return points;
}

// Of points in the sensor frame.
recognition::OrientedCloud CloudFromPoints(recognition::Points points,
                                           const recognition::Pose& world_sensor,
                                           const recognition::DescriptorParameters& parameters) {
  return recognition::PrepareCloud(recognition::Transform(world_sensor, std::move(points)),
                                   world_sensor.translation(), parameters);
}

}  // namespace

absl::StatusOr<std::shared_ptr<const recognition::TaughtView>> ViewFromRecord(
    const storage::ViewRecord& record) {
  const absl::StatusOr<storage::ViewName> name = storage::ParseViewName(record.name());
  absl::StatusOr<recognition::Pose> object = PoseFromProto(record.object_pose(), "object_pose");
  absl::StatusOr<recognition::Pose> sensor = PoseFromProto(record.sensor_pose(), "sensor_pose");
  for (const absl::Status& status : {name.status(), object.status(), sensor.status()}) {
    if (status.ok()) continue;
    return absl::DataLossError(absl::StrCat("the record of view ", record.name(),
                                            " is damaged: ", status.message(), "; ",
                                            std::string(storage::kRestoreAdvice)));
  }
  auto view = std::make_shared<recognition::TaughtView>();
  view->name = record.name();
  view->object = storage::MakeObjectName(name->object_id);
  view->stable_pose = storage::MakeStablePoseName(name->object_id, name->stable_pose_id);
  view->content = record.content_digest();
  view->world_object = *object;
  view->world_sensor = *sensor;
  view->shares_frame = record.object_pose_given();
  return view;
}

const storage::DescriptorRecord* FindDescriptor(
    const storage::ViewRecord& record, const recognition::DescriptorParameters& parameters) {
  const std::string fingerprint = parameters.Fingerprint();
  for (const storage::DescriptorRecord& d : record.descriptors()) {
    if (d.parameters() == fingerprint &&
        d.bins_size() == recognition::DescriptorSize(parameters.kind)) {
      return &d;
    }
  }
  return nullptr;
}

storage::DescriptorRecord NoDescriptor(const recognition::DescriptorParameters& parameters) {
  storage::DescriptorRecord record;
  record.set_kind(std::string(recognition::DescriptorName(parameters.kind)));
  record.set_parameters(parameters.Fingerprint());
  return record;
}

bool IsUndescribable(const storage::ViewRecord& record,
                     const recognition::DescriptorParameters& parameters) {
  const std::string fingerprint = parameters.Fingerprint();
  return std::ranges::any_of(record.descriptors(), [&](const storage::DescriptorRecord& d) {
    return d.parameters() == fingerprint && d.bins().empty();
  });
}

absl::StatusOr<recognition::IndexedView> IndexedViewFromRecord(
    const storage::ViewRecord& record, const recognition::DescriptorParameters& parameters) {
  ASSIGN_OR_RETURN(std::shared_ptr<const recognition::TaughtView> view, ViewFromRecord(record));
  const storage::DescriptorRecord* descriptor = FindDescriptor(record, parameters);
  if (descriptor == nullptr) {
    return absl::InternalError(absl::StrCat("view ", record.name(), " has no descriptor"));
  }
  return recognition::IndexedView{std::move(view),
                                  {descriptor->bins().begin(), descriptor->bins().end()}};
}

absl::StatusOr<recognition::Points> PointsFromPacked(std::string_view packed) {
  ASSIGN_OR_RETURN(std::vector<storage::CloudPoint> unpacked, storage::UnpackCloud(packed));
  return PointsOf(unpacked);
}

absl::StatusOr<recognition::OrientedCloud> CloudFromPacked(
    std::string_view packed, const recognition::Pose& world_sensor,
    const recognition::DescriptorParameters& parameters) {
  ASSIGN_OR_RETURN(recognition::Points points, PointsFromPacked(packed));
  return CloudFromPoints(std::move(points), world_sensor, parameters);
}

recognition::OrientedCloud CloudFromUnpacked(std::vector<storage::CloudPoint> unpacked,
                                             const recognition::Pose& world_sensor,
                                             const recognition::DescriptorParameters& parameters) {
  // Frees the unpacked cloud; the voxels of a large one take several times its memory.
  recognition::Points points = PointsOf(std::exchange(unpacked, {}));
  return CloudFromPoints(std::move(points), world_sensor, parameters);
}

absl::StatusOr<storage::DescriptorRecord> MakeDescriptorRecord(
    const recognition::OrientedCloud& cloud, const recognition::Pose& world_sensor,
    const recognition::DescriptorParameters& parameters) {
  ASSIGN_OR_RETURN(recognition::Descriptor bins,
                   recognition::Describe(cloud, world_sensor, parameters.kind));
  storage::DescriptorRecord record = NoDescriptor(parameters);
  record.mutable_bins()->Assign(bins.begin(), bins.end());
  return record;
}

}  // namespace graspdb::server
