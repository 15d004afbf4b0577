#include "lab/experiment/report/report_json.h"

#include "absl/strings/str_cat.h"
#include "files/json_object.h"
#include "lab/experiment/gallery.h"
#include "lab/experiment/report/answer_drawings.h"
#include "lab/experiment/report/case_figures.h"
#include "lab/experiment/report/settings_text.h"
#include "recognition/base/units.h"

namespace graspdb::client {
namespace {

using google::protobuf::Value;

std::string OutcomeName(recognition::RecognitionOutcome outcome) {
  using enum recognition::RecognitionOutcome;
  switch (outcome) {
    case kOk:
      return "OK";
    case kEmptyRegion:
      return "EMPTY_REGION";
    case kNoCluster:
      return "NO_CLUSTER";
    case kUnknownObject:
      return "UNKNOWN_OBJECT";
    case kAmbiguous:
      return "AMBIGUOUS";
    case kIcpRejected:
      return "ICP_REJECTED";
    case kNoGrasp:
      return "NO_GRASP";
    case kOutOfWorkspace:
      return "OUT_OF_WORKSPACE";
  }
  return "";
}

void FillStand(const Stand& stand, JsonObject out) {
  out.Set(Json("camera", CameraName(stand.camera)), Json("noise_scale", stand.camera.noise.scale),
          Json("look_down_deg", stand.look_down_deg), Json("distance_m", stand.distance_m));
  const recognition::CameraIntrinsics& k = stand.camera.intrinsics;
  out.Object("intrinsics_px")
      .Set(Json("width", k.width), Json("height", k.height), Json("fx", k.fx), Json("fy", k.fy),
           Json("cx", k.cx), Json("cy", k.cy));
}

void FillSettings(const CaseResult& result, JsonObject out) {
  const ExperimentCase& e = result.experiment;
  out.Set(Json("parts", result.set.parts.size()), Json("taught_parts", result.set.taught_count));
  if (!e.is_simulated) return;
  FillStand(e.taught, out.Object("taught"));
  FillStand(e.queried, out.Object("queried"));
  out.Set(Json("teach_step_deg", e.teach_step_deg),
          Json("between_taught_azimuths", e.between_taught_azimuths),
          Json("area_half_width_m", e.area_half_width_m), Json("hidden_share", e.hidden_share),
          Json("objects_per_scene", e.objects_per_scene),
          Json("trials_per_part", e.trials_per_part));
  out.Set(Json("seed", absl::StrCat(e.seed)));  // may be larger than a JSON number is exact
}

void FillSummary(const CaseSummary& s, JsonObject out) {
  out.Set(Json("known", s.known), Json("posed", s.posed), Json("unknown", s.unknown),
          Json("object_right", s.object_right), Json("pose_right", s.pose_right),
          Json("strictly_right", s.strictly_right), Json("ambiguous", s.ambiguous),
          Json("listed", s.listed), Json("mean_rotation_deg", s.mean_rotation_deg),
          Json("mean_translation_mm", s.mean_translation_mm),
          Json("unknown_rejected", s.unknown_rejected));
}

void FillTime(const TimeFigures& times, JsonObject out) {
  out.Set(Json("scenes", times.scenes), Json("mean_ms", times.mean_ms),
          Json("median_ms", times.median_ms), Json("p95_ms", times.p95_ms),
          Json("longest_ms", times.longest_ms));
}

void FillObject(const ObjectFigures& f, JsonObject out) {
  out.Set(Json("object", f.object), Json("known", f.known), Json("query_count", f.query_count),
          Json("falsely_named", f.falsely_named), Json("pose_wrong", f.pose_wrong),
          Json("right_poses", f.right_poses),
          Json("mean_rotation_deg", f.right_poses > 0 ? f.mean_rotation_deg : std::nan("")),
          Json("mean_translation_mm", f.right_poses > 0 ? f.mean_translation_mm : std::nan("")));
}

// The fields of both, by their names, for tests/eval/fit_confidence.py.
void FillEvidence(const recognition::Evidence& evidence,
                  const recognition::ConfidenceFeatures& features, JsonObject out) {
  out.Set(Json("scan_explained", evidence.scan_explained), Json("model_seen", evidence.model_seen),
          Json("unoccluded", evidence.unoccluded), Json("rms_mm", evidence.rms_m * 1e3),
          Json("score", evidence.score), Json("confirmed", evidence.confirmed),
          Json("contradicted", evidence.contradicted), Json("unmeasured", evidence.unmeasured));
  out.Object("features")
      .Set(Json("scan", features.scan), Json("contradicted", features.contradicted),
           Json("residual", features.residual), Json("unseen", features.unseen),
           Json("little", features.little));
}

void FillAnswer(const Answer& a, const PartSet& set, JsonObject out) {
  const Workpiece& part = set.parts[a.part];
  out.Set(Json("scene", a.scene), Json("object_query", part.object_id),
          Json("stable_pose_query", StablePoseName(part)),
          Json("stable_pose_answered", a.stable_pose),
          Json("object_answered", ObjectOf(a.stable_pose)), Json("known", a.known),
          Json("outcome", OutcomeName(a.outcome)), Json("object_right", a.object_right),
          Json("posed", a.posed), Json("pose_right", a.pose_right),
          Json("strictly_right", a.strictly_right), Json("listed", a.listed),
          Json("touching", a.touching), Json("score", a.score), Json("voxels", a.voxels),
          Json("ms", a.milliseconds));
  if (!a.file.empty()) out.Set(Json("file", a.file));
  FillEvidence(a.evidence, a.features, out.Object("evidence"));
  // Null without a pose error.
  const double shown = a.known && a.posed && a.object_right ? 1 : std::nan("");
  out.Set(Json("add_s_mm", shown * a.error.add_s_m * 1e3),
          Json("add_s_share", shown * a.error.add_s_m / set.shapes[a.part]->diameter_m),
          Json("farthest_mm", shown * a.error.hausdorff_m * 1e3),
          Json("rotation_deg", shown * a.error.rotation_rad * recognition::kDegreesPerRadian),
          Json("translation_mm", shown * a.error.translation_m * 1e3));
}

void FillInstance(const FrameInstance& instance, JsonObject out) {
  out.Set(Json("object", instance.object.object), Json("found", instance.found),
          Json("true_pose_score", instance.truth.whole.confidence),
          Json("stage", TextOf(instance.stage())),
          Json("stage_by_segments", TextOf(instance.by_segments)),
          Json("stage_in_image", TextOf(instance.in_image)));
  if (!instance.found) out.Set(Json("lost_by", TextOf(instance.lost_by)));
}

void FillDetection(const FrameDetection& detection, JsonObject out) {
  out.Set(Json("object", detection.object), Json("score", detection.score),
          Json("right", detection.instance.has_value()),
          Json("pose_unknown", detection.pose_unknown), Json("again", detection.again),
          Json("add_s_share", detection.add_s_share), Json("voxels", detection.voxels));
  FillEvidence(detection.evidence, detection.features, out.Object("evidence"));
}

void FillFrame(const FrameResult& result, JsonObject out) {
  out.Set(Json("name", result.frame->name), Json("sensor", result.frame->sensor),
          Json("arrangement", result.frame->arrangement), Json("error", result.error),
          Json("ms", result.milliseconds));
  out.List("objects", result.instances, FillInstance);
  out.List("detections", result.detections, FillDetection);
}

void FillDescriptor(const DescriptorFigures& f, JsonObject out) {
  out.Set(Json("descriptor", f.descriptor), Json("distance", f.distance),
          Json("query_count", f.query_count), Json("object_wrong", f.object_wrong));
  JsonObject objects = out.Object("false_recognition");
  for (const auto& [object, share] : f.false_recognition) objects.Set(Json(object, share));
}

}  // namespace

Value CaseAsJson(const CaseResult& result) {
  Value value;
  JsonObject out(&value);
  out.Set(Json("name", result.experiment.name), Json("description", SettingsText(result)));
  FillSettings(result, out.Object("settings"));
  FillSummary(Summarize(result), out.Object("summary"));
  FillTime(TimesOf(result), out.Object("time"));
  out.List("objects", FiguresByObject(result), FillObject);
  out.List("answers", result.answers, [&](const Answer& answer, JsonObject object) {
    FillAnswer(answer, result.set, object);
  });
  FillDrawings(result, &out);
  FillFirstMatches(result, &out.At("first_matches"));
  return value;
}

absl::StatusOr<std::string> ReportJson(const std::string& command,
                                       const std::vector<DescriptorFigures>& descriptors,
                                       const std::vector<Value>& cases) {
  google::protobuf::Struct document;
  JsonObject out(&document);
  out.Set(Json("command", command), Json("cases", cases));
  out.List("descriptors", descriptors, FillDescriptor);
  return PrintDocument(document, JsonLayout::kIndented);
}

absl::StatusOr<std::string> FramesJson(const std::string& command,
                                       const std::vector<FrameResult>& results) {
  google::protobuf::Struct document;
  JsonObject out(&document);
  out.Set(Json("command", command));
  out.List("frames", results, FillFrame);
  return PrintDocument(document, JsonLayout::kIndented);
}

}  // namespace graspdb::client
