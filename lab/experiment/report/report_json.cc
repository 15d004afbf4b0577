#include "lab/experiment/report/report_json.h"

#include <cmath>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "files/json_object.h"
#include "lab/experiment/gallery.h"
#include "lab/experiment/report/answer_drawings.h"
#include "lab/experiment/report/case_figures.h"
#include "lab/experiment/report/evidence_json.h"
#include "lab/experiment/report/settings_text.h"

namespace graspdb::client {
namespace {

using google::protobuf::Struct;
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

void FillStand(const Stand& stand, Value* value) {
  JsonObject out(value);
  out.Text("camera", CameraName(stand.camera));
  out.Number("noise_scale", stand.camera.noise.scale);
  for (const double angle : stand.look_down_deg) {
    out.At("look_down_deg").mutable_list_value()->add_values()->set_number_value(angle);
  }
  out.Number("distance_m", stand.distance_m);
  const recognition::CameraIntrinsics& k = stand.camera.intrinsics;
  JsonObject intrinsics(&out.At("intrinsics_px"));
  intrinsics.Number("width", k.width);
  intrinsics.Number("height", k.height);
  intrinsics.Number("fx", k.fx);
  intrinsics.Number("fy", k.fy);
  intrinsics.Number("cx", k.cx);
  intrinsics.Number("cy", k.cy);
}

void FillSettings(const CaseResult& result, Value* value) {
  const ExperimentCase& e = result.experiment;
  JsonObject out(value);
  FillStand(e.taught, &out.At("taught"));
  FillStand(e.queried, &out.At("asked"));
  out.Number("teach_step_deg", e.teach_step_deg);
  out.Bool("between_taught_azimuths", e.between_taught_azimuths);
  out.Number("area_half_width_m", e.area_half_width_m);
  out.Number("hidden_share", e.hidden_share);
  out.Number("objects_per_scene", e.objects_per_scene);
  out.Number("trials_per_part", e.trials_per_part);
  out.Text("seed", absl::StrCat(e.seed));  // may be larger than a JSON number is exact
  out.Count("parts", result.set.parts.size());
  out.Count("taught_parts", result.set.taught_count);
}

void FillSummary(const CaseSummary& s, Value* value) {
  JsonObject out(value);
  out.Count("known", s.known);
  out.Count("unknown", s.unknown);
  out.Number("object_right", s.object_right);
  out.Number("pose_right", s.pose_right);
  out.Number("strictly_right", s.strictly_right);
  out.Number("ambiguous", s.ambiguous);
  out.Number("listed", s.listed);
  out.Number("mean_rotation_deg", s.mean_rotation_deg);
  out.Number("mean_translation_mm", s.mean_translation_mm);
  out.Number("unknown_rejected", s.unknown_rejected);
}

void FillTime(const TimeFigures& times, Value* value) {
  JsonObject out(value);
  out.Count("scenes", times.scenes);
  out.Number("mean_ms", times.mean_ms);
  out.Number("median_ms", times.median_ms);
  out.Number("p95_ms", times.p95_ms);
  out.Number("longest_ms", times.longest_ms);
}

void FillObject(const ObjectFigures& f, Value* value) {
  JsonObject out(value);
  out.Text("object", f.object);
  out.Bool("known", f.known);
  out.Count("asked", f.query_count);
  out.Number("falsely_named", f.falsely_named);
  out.Number("pose_wrong", f.pose_wrong);
  out.Count("right_poses", f.right_poses);
  out.Number("mean_rotation_deg", f.right_poses > 0 ? f.mean_rotation_deg : std::nan(""));
  out.Number("mean_translation_mm", f.right_poses > 0 ? f.mean_translation_mm : std::nan(""));
}

void FillAnswer(const Answer& a, const PartSet& set, Value* value) {
  const bool has_error = a.known && a.object_right;
  JsonObject out(value);
  out.Count("scene", a.scene);
  out.Text("object_asked", set.parts[a.part].object_id);
  out.Text("stable_pose_asked", StablePoseName(set.parts[a.part]));
  out.Text("stable_pose_answered", a.stable_pose);
  out.Text("object_answered", ObjectOf(a.stable_pose));
  out.Bool("known", a.known);
  out.Text("outcome", OutcomeName(a.outcome));
  out.Bool("object_right", a.object_right);
  out.Bool("pose_right", a.pose_right);
  out.Bool("strictly_right", a.strictly_right);
  out.Bool("listed", a.listed);
  out.Bool("touching", a.touching);
  out.Number("score", a.score);
  out.Count("voxels", a.voxels);
  FillEvidence(a.evidence, a.features, &out.At("evidence"));
  const auto error = [&](const std::string& key, double number) {
    out.Number(key, has_error ? number : std::nan(""));
  };
  error("add_s_mm", a.error.add_s_m * 1e3);
  error("add_s_share", a.error.add_s_m / set.shapes[a.part]->diameter_m);
  error("farthest_mm", a.error.hausdorff_m * 1e3);
  error("rotation_deg", a.error.rotation_rad * 180 / std::numbers::pi);
  error("translation_mm", a.error.translation_m * 1e3);
  out.Number("ms", a.milliseconds);
}

void FillDescriptor(const DescriptorFigures& f, Value* value) {
  JsonObject out(value);
  out.Text("descriptor", f.descriptor);
  out.Text("distance", f.distance);
  out.Count("asked", f.query_count);
  out.Number("object_wrong", f.object_wrong);
  JsonObject objects(&out.At("false_recognition"));
  for (const auto& [object, share] : f.false_recognition) objects.Number(object, share);
}

}  // namespace

Value CaseAsJson(const CaseResult& result) {
  Value value;
  JsonObject out(&value);
  out.Text("name", result.experiment.name);
  out.Text("description", SettingsText(result));
  FillSettings(result, &out.At("settings"));
  FillSummary(Summarize(result), &out.At("summary"));
  FillTime(TimesOf(result), &out.At("time"));
  auto* objects = out.At("objects").mutable_list_value();
  for (const ObjectFigures& figures : FiguresByObject(result)) {
    FillObject(figures, objects->add_values());
  }
  auto* answers = out.At("answers").mutable_list_value();
  for (const Answer& answer : result.answers) {
    FillAnswer(answer, result.set, answers->add_values());
  }
  FillDrawings(result, &out.At("drawings"));
  FillFirstMatches(result, &out.At("first_matches"));
  return value;
}

absl::StatusOr<std::string> ReportJson(const std::string& command,
                                       const std::vector<DescriptorFigures>& descriptors,
                                       const std::vector<Value>& cases) {
  Struct document;
  auto& fields = *document.mutable_fields();
  fields["command"].set_string_value(command);
  auto* compared = fields["descriptors"].mutable_list_value();
  for (const DescriptorFigures& f : descriptors) FillDescriptor(f, compared->add_values());
  auto* list = fields["cases"].mutable_list_value();
  for (const Value& value : cases) *list->add_values() = value;
  return PrintDocument(document, JsonLayout::kIndented);
}

}  // namespace graspdb::client
