#include "recognition/recognizer.h"

#include <algorithm>

#include "absl/status/status.h"
#include "recognition/descriptor.h"

namespace graspdb::recognition {
namespace {

// What a view gave when it was aligned with a segment.
struct Alignment {
  Pose rough = Pose::Identity();  // T_world_object
  Registration registration;      // moves the view's world onto the scan's
  double score = 0;
};

// Moves the view's cloud to the scan's centroid (the rough pose), refines it and
// judges how well view and scan explain each other.
Alignment AlignView(const TaughtView& view, const OrientedCloud& cloud, const Segment& segment,
                    const PointSearch& search, const MatchingParameters& parameters) {
  Alignment out;
  Pose shift = Pose::Identity();
  shift.translation() = segment.centroid - Centroid(cloud.points);
  out.rough = shift * view.world_object;
  out.registration = Align(cloud.points, {segment.cloud, search}, shift, parameters);

  const Points moved = Transform(out.registration.target_source, cloud.points);
  const double view_by_scan = Support(moved, search, parameters.support_distance_m);
  const double scan_by_view =
      Support(segment.cloud.points, PointSearch(moved), parameters.support_distance_m);
  const double sum = view_by_scan + scan_by_view;
  out.score = sum > 0 ? 2 * view_by_scan * scan_by_view / sum : 0;
  return out;
}

// The grasps of the detection's stable pose in the world frame, the highest
// priority first, without those outside the workspace.
void CarryGrasps(const CatalogueSnapshot& catalogue, const std::optional<Box>& workspace,
                 Detection* detection) {
  const auto found = catalogue.stable_poses->find(detection->view->stable_pose);
  if (found == catalogue.stable_poses->end() || found->second->grasps.empty()) {
    detection->outcome = RecognitionOutcome::kNoGrasp;
    return;
  }
  for (const TaughtGrasp& grasp : found->second->grasps) {
    const Pose world_tcp = detection->refined_pose * grasp.object_tcp;
    if (workspace && !workspace->Contains(world_tcp.translation())) continue;
    detection->grasps.push_back({grasp, world_tcp});
  }
  std::stable_sort(detection->grasps.begin(), detection->grasps.end(),
                   [](const GraspProposal& a, const GraspProposal& b) {
                     return a.grasp.priority > b.grasp.priority;
                   });
  detection->outcome =
      detection->grasps.empty() ? RecognitionOutcome::kOutOfWorkspace : RecognitionOutcome::kOk;
}

// Aligns the nearest views with the segment and keeps the one that explains it best.
absl::Status MatchViews(const Segment& segment, const std::vector<Match>& matches,
                        ViewClouds& clouds, const MatchingParameters& parameters,
                        const IsCancelled& is_cancelled, Detection* detection) {
  const PointSearch search(segment.cloud.points);
  for (std::size_t i = 0; i < matches.size(); ++i) {
    Candidate candidate{matches[i].view, matches[i].distance, std::nullopt};
    if (i < static_cast<std::size_t>(std::max(1, parameters.verified_view_count))) {
      if (is_cancelled()) return absl::CancelledError("cancelled while views were aligned");
      auto cloud = clouds.Load(*candidate.view);
      if (!cloud.ok()) return cloud.status();
      const Alignment alignment = AlignView(*candidate.view, **cloud, segment, search, parameters);
      candidate.verification_score = alignment.score;
      if (!detection->view || alignment.score > detection->score) {
        detection->view = candidate.view;
        detection->score = alignment.score;
        detection->rough_pose = alignment.rough;
        detection->registration = alignment.registration;
        detection->refined_pose =
            alignment.registration.target_source * candidate.view->world_object;
      }
    }
    if (i < static_cast<std::size_t>(std::max(0, parameters.candidate_count))) {
      detection->candidates.push_back(std::move(candidate));
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<Detection> RecognizeSegment(const Segment& segment,
                                           const CatalogueSnapshot& catalogue, ViewClouds& clouds,
                                           const Eigen::Vector3d& viewpoint,
                                           const RecognitionParameters& parameters,
                                           const IsCancelled& is_cancelled, StageLog* log) {
  Detection out;
  out.point_count = segment.cloud.points.size();
  out.centroid = segment.centroid;
  absl::StatusOr<Descriptor> descriptor;
  log->Measure("descriptor", out.point_count, [&] {
    descriptor = Describe(segment.cloud, viewpoint, parameters.descriptor.kind);
    return out.point_count;
  });
  if (!descriptor.ok()) return out;  // a shape that cannot be described is not known
  std::vector<Match> matches;
  const MatchingParameters& matching = parameters.matching;
  log->Measure("match", out.point_count, [&] {
    matches = catalogue.index.Nearest(
        *descriptor, std::max(matching.candidate_count, matching.verified_view_count));
    return out.point_count;
  });
  if (matches.empty()) return out;
  absl::Status status;
  log->Measure("register", out.point_count, [&] {
    status = MatchViews(segment, matches, clouds, matching, is_cancelled, &out);
    return out.point_count;
  });
  if (!status.ok()) return status;
  if (out.registration.inlier_fraction < matching.min_inlier_fraction) {
    out.outcome = RecognitionOutcome::kIcpRejected;
    out.view = nullptr;
  } else if (out.score < matching.min_score) {
    out.outcome = RecognitionOutcome::kUnknownObject;
    out.view = nullptr;
  } else {
    CarryGrasps(catalogue, parameters.workspace, &out);
  }
  return out;
}

// The best that can be said of the frame as a whole.
RecognitionOutcome Summarize(const std::vector<Detection>& detections) {
  for (const Detection& d : detections) {
    if (d.outcome == RecognitionOutcome::kOk) return RecognitionOutcome::kOk;
  }
  return detections.front().outcome;
}

}  // namespace

absl::StatusOr<Recognition> Recognize(const Scan& scan, const CatalogueSnapshot& catalogue,
                                      ViewClouds& clouds, const RecognitionParameters& parameters,
                                      const IsCancelled& is_cancelled) {
  StageLog log;
  absl::StatusOr<Segmentation> segmentation =
      SegmentScan(scan, parameters.segmentation, parameters.descriptor, is_cancelled, &log);
  if (!segmentation.ok()) return segmentation.status();

  Recognition out;
  out.revision = catalogue.revision;
  out.world_sensor = segmentation->world_sensor;
  out.world_frame = segmentation->world_frame;
  for (const Segment& segment : segmentation->segments) {
    absl::StatusOr<Detection> detection = RecognizeSegment(
        segment, catalogue, clouds, out.world_sensor.translation(), parameters, is_cancelled, &log);
    if (!detection.ok()) return detection.status();
    out.detections.push_back(*std::move(detection));
  }
  out.stages = log.reports();
  switch (segmentation->outcome) {
    case SegmentationOutcome::kEmptyRegion:
      out.outcome = RecognitionOutcome::kEmptyRegion;
      break;
    case SegmentationOutcome::kNoCluster:
      out.outcome = RecognitionOutcome::kNoCluster;
      break;
    case SegmentationOutcome::kFound:
      out.outcome = Summarize(out.detections);
      break;
  }
  return out;
}

}  // namespace graspdb::recognition
