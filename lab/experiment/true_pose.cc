#include "lab/experiment/true_pose.h"

#include "absl/strings/str_format.h"
#include "recognition/matching/refinement.h"
#include "recognition/matching/segment_matcher.h"
#include "recognition/points/nearest_grid.h"
#include "recognition/segmentation/segment_part.h"
#include "recognition/simd/soa_cloud.h"
#include "recognition/verification/depth_buffer.h"
#include "recognition/verification/verification.h"

namespace graspdb::lab {
namespace {

using recognition::Pose;
using recognition::Segment;
using recognition::SoaCloud;
using recognition::SurfaceModel;

struct Inputs {
  const recognition::Scan& scan;
  const recognition::Segmentation& segmentation;
  const SurfaceModel& model;
  const recognition::RecognitionParameters& parameters;
};

Segment OwnPart(const Inputs& in, const Segment& segment, const Pose& world_object) {
  const Eigen::Isometry3f object_world = world_object.inverse().cast<float>();
  const auto reach = static_cast<float>(in.parameters.matching.support_distance_m);
  return PartOf(in.scan, in.segmentation, segment, [&](const Eigen::Vector3f& p) {
    return in.model.DistanceTo(object_world * p) < reach;
  });
}

PoseScore Score(const Inputs& in, const Segment& segment, const Pose& initial) {
  const recognition::DepthBuffer depth_buffer(in.scan, in.segmentation.world_sensor, segment);
  const recognition::NearestGrid grid(segment.cloud.points, recognition::kSegmentCellM,
                                      recognition::kSegmentReachM);
  const SoaCloud columns(segment.cloud);
  const recognition::RefinementTarget target{
      segment.cloud,        columns, grid, depth_buffer, in.segmentation.HasGravity(),
      in.segmentation.table};
  PoseScore out;
  out.refined = Refine(in.model, target, initial, {}).world_object;
  const double tolerance = in.parameters.matching.support_distance_m;
  out.evidence = Verify(in.model, out.refined, columns, depth_buffer, {.tolerance_m = tolerance});
  out.features =
      ConfidenceFeaturesOf(out.evidence, in.model, NoiseAt(in.segmentation, segment), tolerance);
  out.confidence = Confidence(out.features);
  return out;
}

}  // namespace

std::string TextOf(const recognition::Evidence& e, const recognition::ConfidenceFeatures& d) {
  return absl::StrFormat(
      "explained %.3f, confirmed %.3f, contradicted %.3f, unmeasured %.3f, rms %.2f mm; "
      "confidence features: scan %.3f, contradicted %.3f, residual %.2f, unseen %.2f, little %.2f",
      e.scan_explained, e.confirmed, e.contradicted, e.unmeasured, e.rms_m * 1e3, d.scan,
      d.contradicted, d.residual, d.unseen, d.little);
}

std::string TextOf(const TruePose& truth) {
  return absl::StrFormat("%d of %d voxels, score %.3f (own points %.3f), F %.3f; %s",
                         truth.own_points, truth.segment_points, truth.whole.confidence,
                         truth.own_score, truth.whole.evidence.score,
                         TextOf(truth.whole.evidence, truth.whole.features));
}

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
  out.centroid = own.centroid;
  out.whole = Score(in, *most, world_object);
  out.own_score = Score(in, own, world_object).confidence;
  return out;
}

}  // namespace graspdb::lab
