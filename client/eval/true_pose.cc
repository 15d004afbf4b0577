#include "client/eval/true_pose.h"

#include "recognition/nearest_grid.h"
#include "recognition/oriented_columns.h"
#include "recognition/refinement.h"
#include "recognition/sight.h"
#include "recognition/verification.h"

namespace graspdb::client {
namespace {

using recognition::Evidence;
using recognition::OrientedColumns;
using recognition::Pose;
using recognition::Segment;
using recognition::SurfaceModel;

// As the recognition's look-ups over a segment, m.
constexpr float kCellM = 0.003F;
constexpr float kReachM = 0.021F;

struct Inputs {
  const recognition::Scan& scan;
  const recognition::Segmentation& segmentation;
  const SurfaceModel& model;
  const recognition::RecognitionParameters& parameters;
};

Segment OwnPart(const Inputs& in, const Segment& segment, const Pose& world_object) {
  const Eigen::Isometry3f object_world = world_object.inverse().cast<float>();
  const Eigen::Isometry3f object_sensor = object_world * in.segmentation.world_sensor.cast<float>();
  const auto reach = static_cast<float>(in.parameters.matching.support_distance_m);
  Segment out;
  for (std::size_t i = 0; i < segment.cloud.points.size(); ++i) {
    if (in.model.DistanceTo(object_world * segment.cloud.points[i]) >= reach) continue;
    out.cloud.points.push_back(segment.cloud.points[i]);
    out.cloud.normals.push_back(segment.cloud.normals[i]);
  }
  for (const std::int32_t i : segment.indices) {
    if (in.model.DistanceTo(object_sensor * in.scan.PointAt(i)) < reach) out.indices.push_back(i);
  }
  out.centroid = recognition::Centroid(out.cloud.points);
  return out;
}

struct Judged {
  Pose refined = Pose::Identity();
  Evidence evidence;
  recognition::Doubt doubt;
  double score = 0;
};

Judged Judge(const Inputs& in, const Segment& segment, const Pose& initial) {
  const recognition::Sight sight(in.scan, in.segmentation.world_sensor, segment);
  const recognition::NearestGrid grid(segment.cloud.points, kCellM, kReachM);
  const OrientedColumns columns(segment.cloud);
  const recognition::RefinementTarget target{
      segment.cloud,
      columns,
      grid,
      sight,
      in.segmentation.world_frame != recognition::WorldFrame::kSensor,
      in.segmentation.table};
  Judged out;
  out.refined = Refine(in.model, target, initial, {}).world_object;
  const double tolerance = in.parameters.matching.support_distance_m;
  out.evidence = Verify(in.model, out.refined, columns, sight, {.tolerance_m = tolerance});
  out.doubt = DoubtsOf(out.evidence, in.model, in.segmentation.table_noise_m, tolerance);
  out.score = Confidence(out.doubt);
  return out;
}

}  // namespace

TruePose ScoreTruth(const recognition::Scan& scan, const recognition::Segmentation& segmentation,
                    const SurfaceModel& model, const Pose& world_object,
                    const recognition::RecognitionParameters& parameters) {
  const Inputs in{scan, segmentation, model, parameters};
  TruePose out;
  const Segment* most = nullptr;
  Segment own;
  for (const Segment& segment : segmentation.segments) {
    Segment part = OwnPart(in, segment, world_object);
    if (part.cloud.points.size() <= out.own_points) continue;
    out.own_points = part.cloud.points.size();
    most = &segment;
    own = std::move(part);
  }
  if (most == nullptr) return out;
  out.segment_points = most->cloud.points.size();
  out.own_share = static_cast<double>(out.own_points) / static_cast<double>(out.segment_points);
  out.centroid = own.centroid;
  const Judged whole = Judge(in, *most, world_object);
  out.refined = whole.refined;
  out.evidence = whole.evidence;
  out.doubt = whole.doubt;
  out.score = whole.score;
  out.own_score = Judge(in, own, world_object).score;
  return out;
}

}  // namespace graspdb::client
