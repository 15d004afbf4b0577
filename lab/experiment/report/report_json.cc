#include "lab/experiment/report/report_json.h"

#include <algorithm>
#include <functional>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "files/base/json_object.h"
#include "lab/experiment/gallery.h"
#include "lab/experiment/report/answer_drawings.h"
#include "lab/experiment/report/case_figures.h"
#include "recognition/base/units.h"

namespace graspdb::lab {
namespace {

using google::protobuf::Value;

// "Kinect v1", "Kinect v2" or "other camera", by the intrinsics.
std::string CameraName(const rendering::DepthCameraModel& camera) {
  const auto is = [&](const rendering::DepthCameraModel& other) {
    return camera.intrinsics.width == other.intrinsics.width &&
           camera.intrinsics.height == other.intrinsics.height &&
           camera.intrinsics.fx == other.intrinsics.fx;
  };
  if (is(rendering::KinectV1())) return "Kinect v1";
  return is(rendering::KinectV2()) ? "Kinect v2" : "other camera";
}

std::string StandText(const Stand& stand) {
  std::string out = absl::StrFormat("%s %.2g m away, looking down %s°", CameraName(stand.camera),
                                    stand.distance_m, absl::StrJoin(stand.look_down_deg, "°, "));
  if (stand.camera.noise.scale != 1) {
    absl::StrAppendFormat(&out, ", its noise times %.2g", stand.camera.noise.scale);
  }
  return out;
}

// Sentences about the taught views and the queries.
std::string SettingsText(const CaseResult& result) {
  const ExperimentCase& e = result.experiment;
  if (!e.settings.empty()) return e.settings;
  std::string out =
      absl::StrFormat("Taught: %d of %d parts at the centre, every %.3g°; %s. Queried: %s; ",
                      result.set.taught_count, result.set.parts.size(), e.teach_step_deg,
                      StandText(e.taught), StandText(e.queried));
  if (e.between_taught_azimuths) {
    absl::StrAppend(&out, "at the centre, at azimuths between the taught ones.");
  } else {
    absl::StrAppendFormat(&out, "anywhere within ±%.2g m, at any azimuth, %d scenes for each part.",
                          e.area_half_width_m, e.trials_per_part);
  }
  if (e.objects_per_scene > 1) {
    absl::StrAppendFormat(&out, " %d objects stand %.2g cm apart in a scene.", e.objects_per_scene,
                          100 * e.gap_m);
  }
  if (e.hidden_share > 0) {
    absl::StrAppendFormat(&out, " An obstacle hides %.3g %% of the object.", 100 * e.hidden_share);
  }
  absl::StrAppend(&out, " Seed ", e.seed, ".");
  return out;
}

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

void FillStand(const Stand& stand, files::JsonObject out) {
  out.Set(files::Json("camera", CameraName(stand.camera)),
          files::Json("noise_scale", stand.camera.noise.scale),
          files::Json("look_down_deg", stand.look_down_deg),
          files::Json("distance_m", stand.distance_m));
  const recognition::CameraIntrinsics& k = stand.camera.intrinsics;
  out.Object("intrinsics_px")
      .Set(files::Json("width", k.width), files::Json("height", k.height), files::Json("fx", k.fx),
           files::Json("fy", k.fy), files::Json("cx", k.cx), files::Json("cy", k.cy));
}

void FillSettings(const CaseResult& result, files::JsonObject out) {
  const ExperimentCase& e = result.experiment;
  out.Set(files::Json("parts", result.set.parts.size()),
          files::Json("taught_parts", result.set.taught_count));
  if (!e.is_simulated) return;
  FillStand(e.taught, out.Object("taught"));
  FillStand(e.queried, out.Object("queried"));
  out.Set(files::Json("teach_step_deg", e.teach_step_deg),
          files::Json("between_taught_azimuths", e.between_taught_azimuths),
          files::Json("area_half_width_m", e.area_half_width_m),
          files::Json("hidden_share", e.hidden_share),
          files::Json("objects_per_scene", e.objects_per_scene),
          files::Json("trials_per_part", e.trials_per_part));
  out.Set(files::Json("seed", absl::StrCat(e.seed)));  // may be larger than a JSON number is exact
}

void FillSummary(const CaseSummary& s, files::JsonObject out) {
  out.Set(files::Json("known", s.known), files::Json("posed", s.posed),
          files::Json("unknown", s.unknown), files::Json("object_right", s.object_right),
          files::Json("pose_right", s.pose_right), files::Json("strictly_right", s.strictly_right),
          files::Json("ambiguous", s.ambiguous), files::Json("listed", s.listed),
          files::Json("mean_rotation_deg", s.mean_rotation_deg),
          files::Json("mean_translation_mm", s.mean_translation_mm),
          files::Json("unknown_rejected", s.unknown_rejected));
}

void FillTime(const TimeFigures& times, files::JsonObject out) {
  out.Set(files::Json("scenes", times.scenes), files::Json("mean_ms", times.mean_ms),
          files::Json("median_ms", times.median_ms), files::Json("p95_ms", times.p95_ms),
          files::Json("longest_ms", times.longest_ms));
}

void FillObject(const ObjectFigures& f, files::JsonObject out) {
  out.Set(
      files::Json("object", f.object), files::Json("known", f.known),
      files::Json("query_count", f.query_count), files::Json("falsely_named", f.falsely_named),
      files::Json("pose_wrong", f.pose_wrong), files::Json("right_poses", f.right_poses),
      files::Json("mean_rotation_deg", f.right_poses > 0 ? f.mean_rotation_deg : std::nan("")),
      files::Json("mean_translation_mm", f.right_poses > 0 ? f.mean_translation_mm : std::nan("")));
}

// The fields of both, by their names, for tests/eval/fit_confidence.py.
void FillEvidence(const recognition::Evidence& evidence,
                  const recognition::ConfidenceFeatures& features, files::JsonObject out) {
  out.Set(files::Json("scan_explained", evidence.scan_explained),
          files::Json("model_seen", evidence.model_seen),
          files::Json("unoccluded", evidence.unoccluded),
          files::Json("rms_mm", evidence.rms_m * 1e3), files::Json("score", evidence.score),
          files::Json("confirmed", evidence.confirmed),
          files::Json("contradicted", evidence.contradicted),
          files::Json("unmeasured", evidence.unmeasured));
  out.Object("features")
      .Set(files::Json("scan", features.scan), files::Json("contradicted", features.contradicted),
           files::Json("residual", features.residual), files::Json("unseen", features.unseen),
           files::Json("little", features.little));
}

// As the BOP challenge takes it: row by row, and in millimetres.
void FillPose(const recognition::Pose& pose, files::JsonObject out) {
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rotation = pose.linear();
  const Eigen::Vector3d translation = pose.translation() * 1e3;
  out.Set(files::Json("rotation", rotation.reshaped<Eigen::RowMajor>()),
          files::Json("translation_mm", translation));
}

void FillPart(const rendering::Workpiece& part, files::JsonObject out) {
  out.Set(files::Json("object", part.object_id), files::Json("stable_pose", part.stable_pose_id));
}

void FillAnswer(const Answer& a, const PartSet& set, files::JsonObject out) {
  const rendering::Workpiece& part = set.parts[a.part];
  out.Set(files::Json("scene", a.scene), files::Json("object_query", part.object_id),
          files::Json("stable_pose_query", StablePoseName(part)),
          files::Json("stable_pose_answered", a.stable_pose),
          files::Json("object_answered", ObjectOf(a.stable_pose)), files::Json("known", a.known),
          files::Json("outcome", OutcomeName(a.outcome)),
          files::Json("object_right", a.object_right), files::Json("posed", a.posed),
          files::Json("pose_right", a.pose_right), files::Json("strictly_right", a.strictly_right),
          files::Json("listed", a.listed), files::Json("touching", a.touching),
          files::Json("score", a.score), files::Json("voxels", a.voxels),
          files::Json("ms", a.milliseconds));
  if (!a.file.empty()) out.Set(files::Json("file", a.file));
  if (const auto found = PartOfFound(a, set)) {
    out.Set(files::Json("part_answered", *found + 1));
    FillPose(a.world_sensor.inverse() * a.found, out.Object("camera_object"));
  }
  FillEvidence(a.evidence, a.features, out.Object("evidence"));
  // Null without a pose error.
  const double shown = a.known && a.posed && a.object_right ? 1 : std::nan("");
  out.Set(
      files::Json("add_s_mm", shown * a.error.add_s_m * 1e3),
      files::Json("add_s_share", shown * a.error.add_s_m / set.shapes[a.part]->diameter_m),
      files::Json("farthest_mm", shown * a.error.hausdorff_m * 1e3),
      files::Json("rotation_deg", shown * a.error.rotation_rad * recognition::kDegreesPerRadian),
      files::Json("translation_mm", shown * a.error.translation_m * 1e3));
}

void FillInstance(const FrameInstance& instance, files::JsonObject out) {
  out.Set(files::Json("object", instance.object.object), files::Json("found", instance.found),
          files::Json("true_pose_score", instance.truth.whole.confidence),
          files::Json("stage", TextOf(instance.stage())),
          files::Json("stage_by_segments", TextOf(instance.by_segments)),
          files::Json("stage_in_image", TextOf(instance.in_image)));
  if (!instance.found) out.Set(files::Json("lost_by", TextOf(instance.lost_by)));
}

void FillDetection(const FrameDetection& detection, files::JsonObject out) {
  out.Set(files::Json("object", detection.object), files::Json("score", detection.score),
          files::Json("right", detection.instance.has_value()),
          files::Json("pose_unknown", detection.pose_unknown),
          files::Json("again", detection.again), files::Json("add_s_share", detection.add_s_share),
          files::Json("voxels", detection.voxels));
  FillPose(detection.sensor_mesh, out.Object("camera_mesh"));
  FillEvidence(detection.evidence, detection.features, out.Object("evidence"));
}

void FillFrame(const FrameResult& result, files::JsonObject out) {
  out.Set(files::Json("name", result.frame->name), files::Json("sensor", result.frame->sensor),
          files::Json("arrangement", result.frame->arrangement), files::Json("error", result.error),
          files::Json("ms", result.milliseconds));
  out.List("objects", result.instances, FillInstance);
  out.List("detections", result.detections, FillDetection);
}

void FillDescriptor(const DescriptorFigures& f, files::JsonObject out) {
  out.Set(files::Json("descriptor", f.descriptor), files::Json("distance", f.distance),
          files::Json("query_count", f.query_count), files::Json("object_wrong", f.object_wrong));
  files::JsonObject objects = out.Object("false_recognition");
  for (const auto& [object, share] : f.false_recognition) objects.Set(files::Json(object, share));
}

constexpr char kSeparated[] = "separated";

using StageOf = std::function<PoseStage(const FrameInstance&)>;
using IsCounted = std::function<bool(const FrameResult&)>;

std::string CountOf(const std::vector<FrameResult>& results, PoseStage reached,
                    const IsCounted& is_counted, const StageOf& stage_of) {
  std::ptrdiff_t count = 0;
  for (const FrameResult& result : results) {
    if (!is_counted(result)) continue;
    count += std::ranges::count_if(result.instances,
                                   [&](const FrameInstance& i) { return stage_of(i) >= reached; });
  }
  return absl::StrCat(count);
}

}  // namespace

std::vector<std::vector<std::string>> StageTable(const std::vector<FrameResult>& results) {
  const auto separated = [](const FrameResult& r) {
    return absl::StrContains(r.frame->arrangement, kSeparated);
  };
  const auto other = [&](const FrameResult& r) { return !separated(r); };
  const auto all = [](const FrameResult&) { return true; };
  std::vector<std::vector<std::string>> table = {
      {"true poses", kSeparated, "other", "all", "by segments", "in the image"}};
  for (const PoseStage stage : kPoseStages) {
    const auto count = [&](const IsCounted& is_counted, const StageOf& stage_of) {
      return CountOf(results, stage, is_counted, stage_of);
    };
    const auto stage_of = &FrameInstance::stage;
    // Either source alone comes as far as the best of an object.
    const bool of_both = stage == PoseStage::kNone || stage == PoseStage::kAccepted;
    table.push_back({stage == PoseStage::kNone ? "all" : TextOf(stage), count(separated, stage_of),
                     count(other, stage_of), count(all, stage_of),
                     of_both ? "" : count(all, &FrameInstance::by_segments),
                     of_both ? "" : count(all, &FrameInstance::in_image)});
  }
  return table;
}

Value CaseAsJson(const CaseResult& result) {
  Value value;
  files::JsonObject out(&value);
  out.Set(files::Json("name", result.experiment.name),
          files::Json("description", SettingsText(result)));
  FillSettings(result, out.Object("settings"));
  FillSummary(Summarize(result), out.Object("summary"));
  FillTime(TimesOf(result), out.Object("time"));
  out.List("parts", result.set.parts, FillPart);
  out.List("objects", FiguresByObject(result), FillObject);
  out.List("answers", result.answers, [&](const Answer& answer, files::JsonObject object) {
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
  files::JsonObject out(&document);
  out.Set(files::Json("command", command), files::Json("cases", cases));
  out.List("descriptors", descriptors, FillDescriptor);
  return files::PrintDocument(document, files::JsonLayout::kIndented);
}

absl::StatusOr<std::string> FramesJson(const std::string& command,
                                       const std::vector<std::string>& object_ids,
                                       const std::vector<FrameResult>& results) {
  google::protobuf::Struct document;
  files::JsonObject out(&document);
  out.Set(files::Json("command", command), files::Json("objects", object_ids),
          files::Json("stages", StageTable(results)));
  out.List("frames", results, FillFrame);
  return files::PrintDocument(document, files::JsonLayout::kIndented);
}

}  // namespace graspdb::lab
