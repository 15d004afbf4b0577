#include "lab/experiment/report/frames_json.h"

#include "files/json_object.h"
#include "lab/experiment/report/evidence_json.h"

namespace graspdb::client {
namespace {

using google::protobuf::Value;

void FillInstance(const FrameInstance& instance, Value* value) {
  JsonObject out(value);
  out.Text("object", instance.object.object);
  out.Bool("found", instance.found);
  if (!instance.found) out.Text("lost_by", TextOf(instance.lost_by));
  out.Number("true_pose_score", instance.truth.whole.confidence);
}

void FillDetection(const FrameDetection& detection, Value* value) {
  JsonObject out(value);
  out.Text("object", detection.object);
  out.Number("score", detection.score);
  out.Bool("right", detection.instance.has_value());
  out.Bool("pose_unknown", detection.pose_unknown);
  out.Bool("again", detection.again);
  out.Number("add_s_share", detection.add_s_share);
  out.Count("voxels", detection.voxels);
  FillEvidence(detection.evidence, detection.features, &out.At("evidence"));
}

void FillFrame(const FrameResult& result, Value* value) {
  JsonObject out(value);
  out.Text("name", result.frame->name);
  out.Text("sensor", result.frame->sensor);
  out.Text("arrangement", result.frame->arrangement);
  out.Text("error", result.error);
  out.Number("ms", result.milliseconds);
  auto* objects = out.At("objects").mutable_list_value();
  for (const FrameInstance& i : result.instances) FillInstance(i, objects->add_values());
  auto* detections = out.At("detections").mutable_list_value();
  for (const FrameDetection& d : result.detections) FillDetection(d, detections->add_values());
}

}  // namespace

absl::StatusOr<std::string> FramesJson(const std::string& command,
                                       const std::vector<FrameResult>& results) {
  google::protobuf::Struct document;
  JsonObject out(&document);
  out.Text("command", command);
  auto* frames = out.At("frames").mutable_list_value();
  for (const FrameResult& result : results) FillFrame(result, frames->add_values());
  return PrintDocument(document, JsonLayout::kIndented);
}

}  // namespace graspdb::client
