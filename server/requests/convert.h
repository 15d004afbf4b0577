// Converts messages of the public contract to the recognition's types and back.
// Errors are INVALID_ARGUMENT and name the field at `path`.
#pragma once

#include <cstddef>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "graspdb/v1/catalog.pb.h"
#include "graspdb/v1/cell.pb.h"
#include "graspdb/v1/geometry.pb.h"
#include "graspdb/v1/recognition_service.pb.h"
#include "recognition/points/scan.h"
#include "recognition/recognizer.h"

namespace graspdb::server {

// Finite, not farther than 1 km from the origin, the quaternion's norm within
// 1e-3 of one; the result is exactly normalised.
absl::StatusOr<recognition::Pose> PoseFromProto(const v1::Pose& pose, std::string_view path);
v1::Pose PoseToProto(const recognition::Pose& pose);

// `parsed`, of PoseFromProto, as it is stored: `given` itself if it has the form of PoseToProto,
// whose last bits another conversion would change, so that a view keeps its bits on its way through
// servers.
v1::Pose StoredPose(const v1::Pose& given, const recognition::Pose& parsed);

// Finite, min below max in every component.
absl::StatusOr<recognition::Box> BoxFromProto(const v1::AxisAlignedBox& box, std::string_view path);

// The grasp as taught; outcomes of picks are no part of the message.
v1::Grasp GraspToProto(const recognition::TaughtGrasp& grasp);

// Replaces the fields that are set. Values out of range are errors.
absl::Status ApplyPipeline(const v1::PipelineParameters& pipeline, std::string_view path,
                           recognition::RecognitionParameters* parameters);

// A stable pose with its grasps; the name is not checked.
absl::StatusOr<recognition::TaughtStablePose> StablePoseFromProto(const v1::StablePose& pose);

// Fills `scan->points` (sensor frame, m), including NaN, from a cloud, or `scan->depth_image` from
// a depth image. INVALID_ARGUMENT with the field for no scan or two, for wrong strides, fields,
// sizes, for more than `max_points` points or pixels, for a scan without a measurement, and for one
// whose coordinates can only be millimetres.
absl::Status ReadScan(const v1::RecognizeRequest& request, std::size_t max_points,
                      recognition::Scan* scan);

// The same for the capture of an upload; the fields are within "view".
absl::Status ReadScan(const v1::View& view, std::size_t max_points, recognition::Scan* scan);

}  // namespace graspdb::server
