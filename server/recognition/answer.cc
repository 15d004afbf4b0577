#include "server/recognition/answer.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "files/messages/pose_message.h"
#include "server/requests/convert.h"

namespace graspdb::server {
namespace {

// The steps from the scan to the objects' points.
constexpr std::array<std::string_view, 9> kSegmentation = {"region",   "range",    "extent",
                                                           "plane",    "outliers", "voxels",
                                                           "clusters", "normals",  "table_pieces"};

v1::RecognitionStatus StatusToProto(recognition::RecognitionOutcome outcome) {
  using Outcome = recognition::RecognitionOutcome;
  switch (outcome) {
    case Outcome::kOk:
      return v1::OK;
    case Outcome::kEmptyRegion:
      return v1::EMPTY_REGION;
    case Outcome::kNoCluster:
      return v1::NO_CLUSTER;
    case Outcome::kUnknownObject:
      return v1::UNKNOWN_OBJECT;
    case Outcome::kAmbiguous:
      return v1::AMBIGUOUS;
    case Outcome::kIcpRejected:
      return v1::ICP_REJECTED;
    case Outcome::kNoGrasp:
      return v1::NO_GRASP;
    case Outcome::kOutOfWorkspace:
      return v1::OUT_OF_WORKSPACE;
  }
  return v1::RECOGNITION_STATUS_UNSPECIFIED;
}

v1::WorldFrameSource SourceToProto(recognition::WorldFrame frame, bool from_cell) {
  switch (frame) {
    case recognition::WorldFrame::kGiven:
      return from_cell ? v1::WORLD_FRAME_SOURCE_CELL : v1::WORLD_FRAME_SOURCE_REQUEST;
    case recognition::WorldFrame::kDominantPlane:
      return v1::WORLD_FRAME_SOURCE_DOMINANT_PLANE;
    case recognition::WorldFrame::kSensor:
      return v1::WORLD_FRAME_SOURCE_SENSOR;
  }
  return v1::WORLD_FRAME_SOURCE_UNSPECIFIED;
}

v1::RejectionGate GateToProto(recognition::Gate gate) {
  switch (gate) {
    case recognition::Gate::kScan:
      return v1::REJECTION_GATE_SCAN;
    case recognition::Gate::kModel:
      return v1::REJECTION_GATE_MODEL;
    case recognition::Gate::kResidual:
      return v1::REJECTION_GATE_RESIDUAL;
    case recognition::Gate::kExtent:
      return v1::REJECTION_GATE_EXTENT;
    case recognition::Gate::kLittleSeen:
      return v1::REJECTION_GATE_LITTLE_SEEN;
    case recognition::Gate::kMinScore:
      return v1::REJECTION_GATE_MIN_SCORE;
  }
  return v1::REJECTION_GATE_UNSPECIFIED;
}

// For clients of before GraspProposal.grasp. Fields that Grasp got later do not belong here.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"
void RepeatGrasp(const v1::Grasp& grasp, v1::GraspProposal* out) {
  out->set_grasp_id(grasp.grasp_id());
  out->set_approach_distance_m(grasp.approach_distance_m());
  out->set_gripper_opening_m(grasp.gripper_opening_m());
  out->set_priority(grasp.priority());
  out->set_retreat_distance_m(grasp.retreat_distance_m());
}
#pragma GCC diagnostic pop

// Left empty for an unknown object, so that the nearest view is not mistaken for a
// result.
void AddPoseAndGrasps(const recognition::Detection& detection,
                      const recognition::CatalogueSnapshot& snapshot, v1::Detection* out) {
  out->set_object(detection.view->object);
  out->set_stable_pose(detection.view->stable_pose);
  out->set_view(detection.view->name);
  *out->mutable_rough_pose() = PoseToProto(detection.rough_pose);
  *out->mutable_refined_pose() = PoseToProto(detection.refined_pose);
  const auto taught = snapshot.stable_poses->find(detection.view->stable_pose);
  if (taught != snapshot.stable_poses->end() && taught->second->object_mesh) {
    *out->mutable_mesh_pose() = PoseToProto(detection.refined_pose * *taught->second->object_mesh);
  }
  for (const recognition::Pose& pose : detection.equivalent_poses) {
    *out->add_equivalent_poses() = PoseToProto(pose);
  }
  for (const recognition::Alternative& other : detection.alternatives) {
    v1::Alternative* alternative = out->add_alternatives();
    alternative->set_object(other.view->object);
    alternative->set_stable_pose(other.view->stable_pose);
    *alternative->mutable_pose() = PoseToProto(other.world_object);
    alternative->set_score(other.score);
  }
  for (const recognition::GraspProposal& proposal : detection.grasps) {
    v1::GraspProposal* grasp = out->add_grasps();
    *grasp->mutable_tcp_pose() = PoseToProto(proposal.world_tcp);
    *grasp->mutable_grasp() = GraspToProto(proposal.grasp);
    RepeatGrasp(grasp->grasp(), grasp);
  }
}

void AddDetection(const recognition::Detection& detection,
                  const recognition::CatalogueSnapshot& snapshot, v1::Detection* out) {
  out->set_status(StatusToProto(detection.outcome));
  if (detection.rejected_by) out->set_rejected_by(GateToProto(*detection.rejected_by));
  out->set_score(detection.score);
  out->set_touching(detection.touching);
  out->set_point_count(static_cast<int>(detection.point_count));
  *out->mutable_centroid() = files::ToMessage(detection.centroid);
  for (const recognition::Candidate& c : detection.candidates) {
    v1::Candidate* candidate = out->add_candidates();
    candidate->set_view(c.view->name);
    candidate->set_descriptor_distance(c.descriptor_distance);
    if (c.verification_score) candidate->set_verification_score(*c.verification_score);
  }
  const recognition::Registration& r = detection.registration;
  if (detection.view || r.iterations > 0) {
    out->mutable_registration()->set_converged(r.converged);
    out->mutable_registration()->set_iteration_count(r.iterations);
    out->mutable_registration()->set_rms_error_m(r.rms_error_m);
    out->mutable_registration()->set_inlier_fraction(r.inlier_fraction);
  }
  if (detection.view) AddPoseAndGrasps(detection, snapshot, out);
}

void AddTimings(const recognition::Recognition& recognition, const AnswerContext& context,
                v1::Timings* out) {
  out->set_total_ms(context.total_ms);
  out->set_decode_ms(context.decode_ms);
  for (const recognition::StageReport& stage : recognition.stages) {
    const double ms = stage.duration_ms;
    if (stage.stage == "descriptor") {
      out->set_describe_ms(ms);
    } else if (stage.stage == "match") {
      out->set_match_ms(ms);
    } else if (std::ranges::find(kSegmentation, stage.stage) != kSegmentation.end()) {
      out->set_segment_ms(out->segment_ms() + ms);
    } else {  // "register" and the steps in the image
      out->set_register_ms(out->register_ms() + ms);
    }
  }
}

}  // namespace

v1::RecognizeResponse MakeAnswer(const recognition::Recognition& recognition,
                                 const recognition::CatalogueSnapshot& snapshot,
                                 const AnswerContext& context) {
  v1::RecognizeResponse out;
  out.set_status(StatusToProto(recognition.outcome));
  out.set_catalog_id(context.catalog_id);
  out.set_catalog_revision(recognition.revision);
  for (const auto& detection : recognition.detections) {
    AddDetection(detection, snapshot, out.add_detections());
  }
  out.set_world_frame_source(SourceToProto(recognition.world_frame, context.sensor_pose_from_cell));
  *out.mutable_sensor_pose() = PoseToProto(recognition.world_sensor);
  for (const recognition::StageReport& stage : recognition.stages) {
    v1::StageReport* report = out.add_stages();
    report->set_stage(stage.stage);
    report->set_input_point_count(static_cast<int>(stage.input_points));
    report->set_output_point_count(static_cast<int>(stage.output_points));
    report->set_duration_ms(stage.duration_ms);
  }
  out.set_untried_view_count(static_cast<int>(recognition.untried_view_count));
  out.set_search_timed_out(recognition.out_of_time);
  AddTimings(recognition, context, out.mutable_timings());
  return out;
}

void LeaveOutTimings(v1::RecognizeResponse* response) {
  response->clear_timings();
  response->clear_catalog_id();
  for (v1::StageReport& stage : *response->mutable_stages()) stage.clear_duration_ms();
}

}  // namespace graspdb::server
