#include "server/catalogue/teacher.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "recognition/points/median_point.h"
#include "recognition/segmentation/segmentation.h"
#include "recognition/segmentation/segmented_points.h"
#include "server/base/errors.h"
#include "server/live/records.h"
#include "server/requests/convert.h"
#include "server/requests/record_checks.h"
#include "storage/base/crc32c.h"
#include "storage/records/packed_cloud.h"

namespace graspdb::server {
namespace {

using recognition::Pose;
using recognition::Segment;
using recognition::Segmentation;

struct Capture {
  recognition::Scan scan;
  std::optional<Pose> object_pose;
};

// What a capture shows of the object.
struct SeenObject {
  Pose world_sensor = Pose::Identity();
  Pose world_object = Pose::Identity();
  recognition::Indices indices;  // its points in the scan
};

absl::StatusOr<Capture> CaptureFromProto(const v1::UploadViewsRequest& request,
                                         std::size_t max_points) {
  Capture out;
  const v1::View& view = request.view();
  RETURN_IF_ERROR(ReadScan(view, max_points, &out.scan));
  out.scan.segmented = view.segmented();
  if (view.has_sensor_pose()) {
    ASSIGN_OR_RETURN(out.scan.world_sensor, PoseFromProto(view.sensor_pose(), "view.sensor_pose"));
  }
  if (view.has_object_pose()) {
    ASSIGN_OR_RETURN(out.object_pose, PoseFromProto(view.object_pose(), "view.object_pose"));
  }
  if (request.has_region_of_interest()) {
    ASSIGN_OR_RETURN(out.scan.region,
                     BoxFromProto(request.region_of_interest(), "region_of_interest"));
  }
  return out;
}

// The segment of the object: the only one, or the one at the object's pose.
absl::StatusOr<const Segment*> ChooseSegment(const recognition::Scan& scan,
                                             const Segmentation& segmentation,
                                             const std::optional<Pose>& object_pose) {
  switch (segmentation.outcome) {
    case recognition::SegmentationOutcome::kEmptyRegion:
      return WithReason(absl::FailedPreconditionError(absl::StrCat(
                            "the region of interest holds no measurement; check the sensor pose "
                            "and the region",
                            recognition::AndWhereMedianIs(scan, segmentation.world_sensor))),
                        "EMPTY_REGION");
    case recognition::SegmentationOutcome::kNoCluster:
      return WithReason(
          absl::FailedPreconditionError(absl::StrCat(
              "nothing stands on the table in the region of interest; check the sensor "
              "pose and the region",
              recognition::AndWhereMedianIs(scan, segmentation.world_sensor))),
          "NO_CLUSTER");
    case recognition::SegmentationOutcome::kFound:
      break;
  }
  const std::vector<Segment>& segments = segmentation.segments;
  if (!object_pose) {
    if (segments.size() == 1) return &segments.front();
    return WithReason(
        absl::FailedPreconditionError(absl::StrCat(
            "the capture shows ", segments.size(),
            " objects and no object pose selects the taught one; clear the table or give a pose")),
        "SEVERAL_CLUSTERS");
  }
  const auto distance = [&](const Segment& segment) {
    return (segment.centroid - object_pose->translation()).head<2>().norm();
  };
  return &*std::ranges::min_element(segments, {}, distance);
}

// `stored` gets the points as they will be read.
absl::StatusOr<std::string> PackPoints(const recognition::Scan& scan,
                                       const recognition::Indices& indices,
                                       std::vector<storage::CloudPoint>* stored) {
  std::vector<storage::CloudPoint> points;
  points.reserve(indices.size());
  for (const std::int32_t i : indices) {
    const Eigen::Vector3f p = scan.PointAt(i);
    points.push_back({p.x(), p.y(), p.z()});
  }
  return storage::PackCloud(points, stored);
}

// Measurements far from the object would be taught with it.
absl::Status CheckExtent(const recognition::Scan& scan, const Segmentation& segmentation,
                         const Segment& segment, double max_object_size_m) {
  const char* field = scan.is_image() ? "view.depth_image" : "view.cloud";
  if (segmentation.far_point_count > 0) {
    return InvalidField(
        field,
        absl::StrCat("has ", segmentation.far_point_count, " points more than ", max_object_size_m,
                     " m from the others; leave out points that are not on the "
                     "object"));
  }
  if (!segment.too_large) return absl::OkStatus();
  return InvalidField(field, absl::StrCat("shows an object larger than ", max_object_size_m,
                                          " m; leave out points that are not on the object"));
}

absl::StatusOr<SeenObject> FindObject(const Capture& capture,
                                      const recognition::RecognitionParameters& parameters,
                                      const recognition::IsCancelled& is_cancelled) {
  // The centroid of the voxels, which takes longer, is for objects without a pose.
  if (capture.object_pose) {
    std::optional<recognition::Indices> indices = recognition::SegmentedPoints(
        capture.scan, parameters.segmentation, parameters.descriptor.voxel_size_m, is_cancelled);
    if (indices) {
      return SeenObject{capture.scan.world_sensor.value_or(Pose::Identity()), *capture.object_pose,
                        *std::move(indices)};
    }
  }
  recognition::StageLog log;
  // The normals that count are those of the points as they are stored.
  recognition::DescriptorParameters without_normals = parameters.descriptor;
  without_normals.normal_radius_m = 0;
  ASSIGN_OR_RETURN(Segmentation segmentation,
                   recognition::SegmentScan(capture.scan, parameters.segmentation, without_normals,
                                            is_cancelled, &log));
  // What is taught stands on a table.
  if (!segmentation.HasGravity() && !capture.scan.segmented) {
    return recognition::NoTable(capture.scan);
  }
  ASSIGN_OR_RETURN(const Segment* segment,
                   ChooseSegment(capture.scan, segmentation, capture.object_pose));
  const double max_size_m = parameters.segmentation.max_object_size_m;
  RETURN_IF_ERROR(CheckExtent(capture.scan, segmentation, *segment, max_size_m));
  return SeenObject{segmentation.world_sensor,
                    capture.object_pose.value_or(
                        recognition::DefaultObjectPose(segmentation.world_frame, *segment)),
                    segment->indices};
}

absl::Status CheckChecksum(const v1::UploadViewsRequest& request) {
  if (!request.has_cloud_crc32c()) return absl::OkStatus();
  const v1::View& view = request.view();
  const bool is_image = view.has_depth_image();
  const std::string& data = is_image ? view.depth_image().data() : view.cloud().data();
  if (storage::Crc32c(data) == request.cloud_crc32c()) return absl::OkStatus();
  return InvalidField("cloud_crc32c",
                      absl::StrCat("is not that of view.", is_image ? "depth_image" : "cloud",
                                   ".data; send the view again"));
}

}  // namespace

std::string UploadDigest(const v1::UploadViewsRequest& request) {
  v1::UploadViewsRequest content;
  *content.mutable_view() = request.view();
  content.mutable_view()->clear_name();
  *content.mutable_region_of_interest() = request.region_of_interest();
  return Sha256(content.SerializeAsString());
}

absl::StatusOr<storage::NewView> MakeView(const v1::UploadViewsRequest& request,
                                          const recognition::RecognitionParameters& parameters,
                                          const TeachLimits& limits,
                                          const recognition::IsCancelled& is_cancelled) {
  RETURN_IF_ERROR(CheckChecksum(request));
  ASSIGN_OR_RETURN(Capture capture, CaptureFromProto(request, limits.max_points));
  ASSIGN_OR_RETURN(const SeenObject object, FindObject(capture, parameters, is_cancelled));

  storage::NewView out;
  std::vector<storage::CloudPoint> stored;
  ASSIGN_OR_RETURN(out.packed_cloud, PackPoints(capture.scan, object.indices, &stored));
  const v1::View& view = request.view();
  const v1::Pose stored_sensor = view.has_sensor_pose()
                                     ? StoredPose(view.sensor_pose(), object.world_sensor)
                                     : PoseToProto(object.world_sensor);
  // As it will be read, as the points are.
  ASSIGN_OR_RETURN(Pose sensor, PoseFromProto(stored_sensor, "view.sensor_pose"));
  ASSIGN_OR_RETURN(
      storage::DescriptorRecord descriptor,
      MakeDescriptorRecord(CloudFromUnpacked(std::move(stored), sensor, parameters.descriptor),
                           sensor, parameters.descriptor));

  *out.record.mutable_sensor_pose() = stored_sensor;
  *out.record.mutable_object_pose() = capture.object_pose
                                          ? StoredPose(view.object_pose(), object.world_object)
                                          : PoseToProto(object.world_object);
  out.record.set_object_pose_given(view.has_object_pose() && !view.object_pose_estimated());
  out.record.set_point_count(static_cast<int>(object.indices.size()));
  *out.record.add_descriptors() = std::move(descriptor);
  return out;
}

}  // namespace graspdb::server
