#include "lab/experiment/answer.h"

#include "absl/strings/str_format.h"
#include "lab/experiment/gallery.h"
#include "recognition/matching/refinement.h"
#include "recognition/matching/segment_matcher.h"
#include "recognition/points/nearest_grid.h"
#include "recognition/segmentation/segment_part.h"
#include "recognition/simd/soa_cloud.h"
#include "recognition/verification/depth_buffer.h"
#include "recognition/verification/verification.h"

namespace graspdb::lab {
namespace {

using recognition::Detection;
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

// One way to read an answer.
struct Reading {
  const recognition::TaughtView* view = nullptr;
  Pose world_object = Pose::Identity();
};

// The answer itself first; the further readings if it is ambiguous.
std::vector<Reading> ReadingsOf(const Detection& detection) {
  std::vector<Reading> out = {{detection.view.get(), detection.refined_pose}};
  if (detection.outcome != recognition::RecognitionOutcome::kAmbiguous) return out;
  for (const Pose& pose : detection.equivalent_poses) out.push_back({detection.view.get(), pose});
  for (const recognition::Alternative& a : detection.alternatives) {
    out.push_back({a.view.get(), a.world_object});
  }
  return out;
}

// The nearest to the camera if the true pose is unknown.
const Detection* DetectionOf(const recognition::Recognition& recognition, const Trial& trial,
                             std::size_t which) {
  if (recognition.detections.empty()) return nullptr;
  if (!trial.posed) return &recognition.detections.front();
  const Eigen::Vector3d& seen = trial.seen[which];
  return &*std::ranges::min_element(recognition.detections, {}, [&](const Detection& d) {
    return (d.centroid - seen).head<2>().norm();
  });
}

Answer JudgeReading(const Reading& reading, const PartSet& set, Answer answer) {
  answer.stable_pose = reading.view->stable_pose;
  answer.view = reading.view->name;
  answer.found = reading.world_object;
  if (!answer.known || reading.view->object != ObjectName(set.parts[answer.part])) return answer;
  answer.object_right = true;
  answer.posed = answer.posed && reading.view->shares_frame;
  if (!answer.posed) return answer;
  const rendering::MeasuredShape& shape = *set.shapes[answer.part];
  const auto answered = static_cast<std::size_t>(
      std::ranges::find(set.parts, answer.stable_pose, StablePoseName) - set.parts.begin());
  // Both stable poses are the same mesh at rest.
  answer.found =
      reading.world_object * set.object_mesh[answered] * set.object_mesh[answer.part].inverse();
  answer.error = rendering::ErrorOf(shape, answer.truth, answer.found);
  answer.pose_right = rendering::IsRight(shape, answer.error.add_s_m);
  answer.strictly_right = rendering::IsStrictlyRight(shape, answer.error);
  return answer;
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

bool IsWrong(const Answer& answer) {
  return !(answer.known && answer.posed ? answer.strictly_right : answer.object_right);
}

Answer JudgeAnswer(const recognition::Recognition& recognition, const Trial& trial,
                   std::size_t which, const PartSet& set) {
  const rendering::Placement& truth = trial.truth[which];
  Answer seen{.part = truth.part,
              .known = set.IsTaught(truth.part),
              .posed = trial.posed,
              .outcome = recognition.outcome,
              .world_sensor = recognition.world_sensor,
              .truth = truth.world_object};
  const Detection* detection = DetectionOf(recognition, trial, which);
  if (detection != nullptr) {
    seen.outcome = detection->outcome;
    seen.touching = detection->touching;
    seen.score = detection->score;
    seen.features = detection->features;
    seen.evidence = detection->evidence;
    seen.voxels = detection->point_count;
    seen.candidates = detection->candidates;
    seen.found = detection->refined_pose;
  }
  if (detection == nullptr || !detection->view) {
    seen.object_right = !seen.known;
    return seen;
  }
  const std::vector<Reading> readings = ReadingsOf(*detection);
  Answer first = JudgeReading(readings.front(), set, seen);
  if (first.strictly_right || (first.object_right && !first.posed)) return first;
  for (std::size_t i = 1; i < readings.size(); ++i) {
    const Answer further = JudgeReading(readings[i], set, seen);
    if (!further.strictly_right) continue;
    first.object_right = first.pose_right = first.strictly_right = first.listed = true;
    first.error = further.error;
    break;
  }
  return first;
}

}  // namespace graspdb::lab
