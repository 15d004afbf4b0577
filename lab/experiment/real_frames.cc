#include "lab/experiment/real_frames.h"

#include <chrono>
#include <utility>

#include "base/status_macros.h"
#include "client/teaching/mesh/cad_part.h"
#include "files/points/point_file.h"
#include "lab/experiment/trials/cases.h"
#include "rendering/mesh_part.h"

namespace graspdb::lab {
namespace {

using recognition::Detection;
using recognition::Pose;
using recognition::PoseSource;
using recognition::PoseStep;

// A pose is at the place of an object whose centre is nearer than this share of the diameter. At
// other places the scan may show the object again.
constexpr double kPlaceShare = 0.5;

bool IsAtPlace(const rendering::MeasuredShape& shape, const Pose& a, const Pose& b) {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const auto& p : shape.points) center += p.cast<double>();
  center /= static_cast<double>(shape.points.size());
  return (a * center - b * center).norm() < kPlaceShare * shape.diameter_m;
}

PoseStage StageOf(PoseStep step) {
  switch (step) {
    case PoseStep::kProposed:
      return PoseStage::kProposed;
    case PoseStep::kKept:
      return PoseStage::kKept;
    case PoseStep::kRefined:
      return PoseStage::kRefined;
  }
  return PoseStage::kNone;
}

// Like graspdb teach --mesh.
constexpr double kTeachStepDeg = 20;

absl::Status AddMesh(const FrameObject& object, PartSet* set) {
  ASSIGN_OR_RETURN(const auto mesh, rendering::LoadPartMesh(object.mesh, object.unit_m));
  ASSIGN_OR_RETURN(auto part,
                   client::ProposeCadPart(rendering::ObjectIdOf(object.object), "", mesh, {}));
  for (std::size_t i = 0; i < part.workpieces.size(); ++i) {
    set->Add(std::move(part.workpieces[i]), part.found.poses[i].object_mesh);
  }
  return absl::OkStatus();
}

std::size_t PartOf(const PartSet& set, const std::string& stable_pose) {
  return static_cast<std::size_t>(std::ranges::find(set.parts, stable_pose, StablePoseName) -
                                  set.parts.begin());
}

// The stable pose of `object` with the most upright mesh.
std::size_t PoseAtRest(const PartSet& set, const std::string& object, const Pose& world_mesh) {
  std::size_t best = set.parts.size();
  double upright = -2;
  for (std::size_t i = 0; i < set.parts.size(); ++i) {
    const double cosine = (world_mesh * set.object_mesh[i].inverse()).linear()(2, 2);
    if (set.parts[i].object_id != rendering::ObjectIdOf(object) || cosine <= upright) continue;
    upright = cosine;
    best = i;
  }
  return best;
}

FrameDetection Judge(const PartSet& set, const Detection& detection, const RealFrame& frame,
                     const Pose& world_sensor) {
  const std::size_t answered = PartOf(set, detection.view->stable_pose);
  FrameDetection out{.object = set.parts[answered].object_id, .score = detection.score};
  out.sensor_mesh = world_sensor.inverse() * detection.refined_pose * set.object_mesh[answered];
  for (std::size_t i = 0; i < frame.objects.size(); ++i) {
    const FrameObject& object = frame.objects[i];
    if (rendering::ObjectIdOf(object.object) != out.object) continue;
    if (!object.sensor_mesh) {
      out.pose_unknown = true;
      continue;
    }
    const double share =
        ShareOff(set, answered, detection.refined_pose, world_sensor * *object.sensor_mesh);
    out.add_s_share = std::min(out.add_s_share, share);
    if (share < kFoundShare) out.instance = i;
  }
  out.pose_unknown = out.pose_unknown && !out.instance;
  return out;
}

std::vector<FrameDetection> JudgeAll(const PartSet& set, const recognition::Recognition& answer,
                                     const RealFrame& frame) {
  std::vector<FrameDetection> out;
  for (const Detection& detection : answer.detections) {
    if (detection.view == nullptr) continue;
    FrameDetection judged = Judge(set, detection, frame, answer.world_sensor);
    judged.voxels = detection.point_count;
    judged.evidence = detection.evidence;
    judged.features = detection.features;
    judged.again = judged.instance && std::ranges::any_of(out, [&](const FrameDetection& other) {
                     return other.instance == judged.instance;
                   });
    out.push_back(std::move(judged));
  }
  return out;
}

// Those of the detections; `judged` has the accepted ones in the same order.
std::vector<PosedModel> PosesOf(const recognition::Recognition& answer,
                                const std::vector<FrameDetection>& judged) {
  const Pose sensor_world = answer.world_sensor.inverse();
  std::vector<PosedModel> out;
  for (const Detection& detection : answer.detections) {
    if (detection.view == nullptr) continue;
    const bool is_wrong = judged[out.size()].IsWrong();
    out.push_back({detection.model, sensor_world * detection.refined_pose,
                   is_wrong ? PosedModel::Verdict::kWrong : PosedModel::Verdict::kRight});
  }
  std::erase_if(out, [](const PosedModel& posed) { return posed.model == nullptr; });
  return out;
}

LostBy WhereLost(const FrameInstance& instance) {
  // Minimum share of an object in its segment.
  constexpr double kMinOwnShare = 0.5;
  if (instance.best_is_right) return LostBy::kConfidence;
  if (instance.truth.own_share() < kMinOwnShare) return LostBy::kSegmentation;
  return instance.best_explains < instance.truth.whole.evidence.score ? LostBy::kSearch
                                                                      : LostBy::kRanking;
}

// The detection at the place of `instance`.
void AddBest(const recognition::Recognition& recognition, const FramesCatalogue& catalogue,
             const Pose& world_mesh, FrameInstance* instance) {
  if (recognition.detections.empty() || instance->truth.own_points == 0) return;
  const Detection& best = *std::ranges::min_element(
      recognition.detections, {},
      [&](const Detection& d) { return (d.centroid - instance->truth.centroid).squaredNorm(); });
  const std::string object = rendering::ObjectIdOf(instance->object.object);
  instance->best_score = best.score;
  instance->best_explains = best.evidence.score;
  const PartSet& set = catalogue.set();
  for (std::size_t i = 0; i < set.parts.size() && best.model; ++i) {
    if (catalogue.ModelOf(i) != best.model) continue;
    instance->best_object = set.parts[i].object_id;
    instance->best_is_right = instance->best_object == object &&
                              ShareOff(set, i, best.refined_pose, world_mesh) < kFoundShare;
  }
  for (std::size_t i = 0; i < best.candidates.size() && instance->rank == 0; ++i) {
    if (best.candidates[i].view->object == "objects/" + object) {
      instance->rank = static_cast<int>(i) + 1;
    }
  }
}

// Ids of the objects in the frame whose poses are known.
std::vector<std::string> PosedObjects(const RealFrame& frame) {
  std::vector<std::string> out;
  for (const FrameObject& object : frame.objects) {
    if (object.sensor_mesh) out.push_back(rendering::ObjectIdOf(object.object));
  }
  return out;
}

}  // namespace

const char* TextOf(PoseStage stage) {
  switch (stage) {
    case PoseStage::kNone:
      return "nothing";
    case PoseStage::kProposed:
      return "proposed";
    case PoseStage::kKept:
      return "kept";
    case PoseStage::kRefined:
      return "refined";
    case PoseStage::kBest:
      return "best of its object";
    case PoseStage::kAccepted:
      return "accepted";
  }
  return "";
}

PoseStage After(PoseStage stage) { return static_cast<PoseStage>(static_cast<int>(stage) + 1); }

PoseRecord::PoseRecord(const PartSet& set, const std::vector<std::string>& object_ids) : set_(set) {
  for (std::size_t i = 0; i < set.parts.size(); ++i) {
    if (std::ranges::find(object_ids, set.parts[i].object_id) == object_ids.end()) continue;
    parts_[StablePoseName(set.parts[i])] = i;
  }
}

recognition::PoseObserver PoseRecord::Observer() {
  return
      [this](PoseStep step, PoseSource source, std::span<const recognition::ObservedPose> poses) {
        Step seen{step, source, {}};
        for (const recognition::ObservedPose& pose : poses) {
          const auto part = parts_.find(pose.stable_pose);
          if (part != parts_.end()) seen.poses.push_back({part->second, pose.world_object});
        }
        if (seen.poses.empty()) return;
        const std::lock_guard lock(mutex_);
        steps_.push_back(std::move(seen));
      };
}

PoseStage PoseRecord::StageOf(const std::string& object_id, const Pose& world_mesh,
                              PoseSource source) const {
  PoseStage furthest = PoseStage::kNone;
  for (const Step& step : steps_) {
    const PoseStage stage = lab::StageOf(step.step);
    const bool refined = stage == PoseStage::kRefined;
    if (step.source != source || (stage <= furthest && !refined)) continue;
    bool is_best = refined;
    for (const auto& [part, world_object] : step.poses) {
      const rendering::MeasuredShape& shape = *set_.shapes[part];
      if (set_.parts[part].object_id != object_id ||
          !IsAtPlace(shape, world_object, world_mesh * set_.object_mesh[part].inverse())) {
        continue;
      }
      if (ShareOff(set_, part, world_object, world_mesh) < (refined ? kFoundShare : kNearShare)) {
        furthest = std::max(furthest, is_best ? PoseStage::kBest : stage);
        break;
      }
      is_best = false;
    }
  }
  return furthest;
}

double ShareOff(const PartSet& set, std::size_t position, const Pose& world_object,
                const Pose& world_mesh) {
  const rendering::MeasuredShape& shape = *set.shapes[position];
  return rendering::AddS(shape, world_mesh * set.object_mesh[position].inverse(), world_object) /
         shape.diameter_m;
}

const char* TextOf(LostBy lost_by) {
  switch (lost_by) {
    case LostBy::kSegmentation:
      return "no segment of its own";
    case LostBy::kSearch:
      return "not searched there";
    case LostBy::kRanking:
      return "something explains more";
    case LostBy::kConfidence:
      return "score below the minimum";
  }
  return "";
}

absl::StatusOr<std::unique_ptr<FramesCatalogue>> FramesCatalogue::Teach(
    const std::vector<RealFrame>& frames, const ExperimentRun& run) {
  std::map<std::string, FrameObject> meshes;
  for (const RealFrame& frame : frames) {
    for (const FrameObject& object : frame.objects) {
      if (object.object.empty()) continue;
      meshes.try_emplace(rendering::ObjectIdOf(object.object), object);
    }
  }
  auto out = std::make_unique<FramesCatalogue>();
  for (const auto& [name, object] : meshes) {
    RETURN_IF_ERROR(AddMesh(object, &out->set_));
    out->object_ids_.push_back(name);
  }
  out->set_.taught_count = out->set_.parts.size();
  ASSIGN_OR_RETURN(const auto trials,
                   RenderedTrials({.name = "real", .teach_step_deg = kTeachStepDeg}, out->set_));
  out->gallery_ = std::make_unique<Gallery>(out->set_.parts, run.parameters);
  RETURN_IF_ERROR(out->gallery_->Teach(trials.teaching, "teaching", run));
  out->snapshot_ = out->gallery_->Snapshot();
  // A server makes models before the first request.
  for (const rendering::Workpiece& part : out->set_.parts) {
    out->models_.push_back(out->gallery_->ModelOf(part));
  }
  return out;
}

absl::StatusOr<recognition::Scan> ReadScan(const RealFrame& frame) {
  ASSIGN_OR_RETURN(auto file, files::ReadPointFile(frame.path));
  return recognition::Scan{.points = std::move(file.points),
                           .world_sensor = file.sensor_pose,
                           .region = {},
                           .width = file.image_width()};
}

FrameResult RecognizeFrame(const RealFrame& frame, const recognition::Scan& scan,
                           const ExperimentRun& run, FramesCatalogue* catalogue) {
  const auto never = [] { return false; };
  FrameResult out{.frame = &frame};
  PoseRecord record(catalogue->set(), PosedObjects(frame));
  recognition::RecognitionParameters parameters = run.parameters;
  parameters.matching.observer = record.Observer();
  const auto start = std::chrono::steady_clock::now();
  const auto recognition =
      recognition::Recognize(scan, catalogue->snapshot(), catalogue->gallery(), parameters, never);
  out.milliseconds =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  recognition::StageLog log;
  const auto segmentation = recognition::SegmentScan(scan, run.parameters.segmentation,
                                                     run.parameters.descriptor, never, &log);
  const bool answered = recognition.ok() && segmentation.ok();
  if (answered) {
    out.segments = segmentation->segments.size();
    out.stages = recognition->stages;
    out.detections = JudgeAll(catalogue->set(), *recognition, frame);
    out.posed = PosesOf(*recognition, out.detections);
  } else {
    out.error = std::string(recognition.status().message());
  }
  for (std::size_t i = 0; i < frame.objects.size(); ++i) {
    const FrameObject& object = frame.objects[i];
    if (!object.sensor_mesh) continue;
    FrameInstance& instance = out.instances.emplace_back(FrameInstance{.object = object});
    instance.found =
        std::ranges::any_of(out.detections, [&](const auto& d) { return d.instance == i; });
    if (!answered) continue;
    const Pose world_mesh = recognition->world_sensor * *object.sensor_mesh;
    const std::size_t part = PoseAtRest(catalogue->set(), object.object, world_mesh);
    instance.truth =
        ScoreTruth(scan, *segmentation, *catalogue->ModelOf(part),
                   world_mesh * catalogue->set().object_mesh[part].inverse(), run.parameters);
    AddBest(*recognition, *catalogue, world_mesh, &instance);
    instance.lost_by = WhereLost(instance);
    const auto stage_by = [&](recognition::PoseSource source) {
      return record.StageOf(rendering::ObjectIdOf(object.object), world_mesh, source);
    };
    instance.by_segments = stage_by(recognition::PoseSource::kSegment);
    instance.in_image = stage_by(recognition::PoseSource::kImage);
    if (instance.found) continue;
    out.posed.push_back({catalogue->ModelOf(part),
                         *object.sensor_mesh * catalogue->set().object_mesh[part].inverse(),
                         PosedModel::Verdict::kLost});
  }
  return out;
}

}  // namespace graspdb::lab
