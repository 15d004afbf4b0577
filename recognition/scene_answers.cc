#include "recognition/scene_answers.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <unordered_map>
#include <unordered_set>

#include "recognition/base/idle_cores.h"
#include "recognition/scene/scene_score.h"
#include "recognition/segment_recognition.h"
#include "recognition/segmentation/region.h"

namespace graspdb::recognition {
namespace {

// Of a hypothesis, the share of what it sees that another answer may already explain.
constexpr float kMaxClaimed = 0.3F;
// A segment of which this share lies on a new detection is that detection's.
constexpr double kOwnShare = 0.6;
// Cells of claimed pixels, pixels a side: the gaps between the points of a model are smaller.
constexpr int kClaimCell = 4;
// No confidence in an answer is nearer to 0 or 1.
constexpr double kMinConfidence = 0.015;
// Surfaces nearer than this are the same when pixels are claimed, m.
constexpr float kClaimM = 0.012F;
// Steps of SceneSample, as powers of this from 4 mm on.
constexpr double kSampleBase = 1.5;
constexpr float kFinestSampleM = 0.004F;

double ScoreOf(double log_odds) { return 1 / (1 + std::exp(-log_odds)); }

// An object that may be in the frame.
struct SceneObject {
  StablePoses stable_poses;
  std::shared_ptr<const PairModel> model;  // in the frame of the mesh, or of the only stable pose
};

struct Proposal {
  std::size_t object = 0;
  SceneHypothesis hypothesis;
  double log_odds = 0;
};

class Scene {
 public:
  Scene(const Scan& scan, const Segmentation& segmentation, const CatalogueSnapshot& catalogue,
        ViewClouds& clouds, const RecognitionParameters& parameters,
        const IsCancelled& is_cancelled)
      : scan_(scan),
        segmentation_(segmentation),
        catalogue_(catalogue),
        clouds_(clouds),
        parameters_(parameters),
        is_cancelled_(is_cancelled),
        groups_(PairModelGroups(*catalogue.stable_poses)) {
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      for (const auto& stable_pose : groups_[g]) group_of_[stable_pose->name] = g;
    }
  }

  std::size_t MakeFrameOfScan() {
    const Box region = scan_.region.value_or(DefaultRegion(segmentation_.world_sensor));
    frame_ = MakeFrame(scan_, segmentation_.world_sensor, segmentation_.table, region,
                       parameters_.scene.frame, is_cancelled_);
    return static_cast<std::size_t>(std::ranges::count(frame_.role, PixelRole::kObject));
  }

  absl::Status Verify(std::vector<AnsweredSegment>* answers);
  absl::StatusOr<std::vector<Proposal>> Propose(const std::vector<AnsweredSegment>& answers);
  absl::Status Explain(const std::vector<Proposal>& proposals,
                       std::vector<AnsweredSegment>* answers);

 private:
  absl::StatusOr<SceneObject> ObjectAt(std::size_t group) {
    auto model = clouds_.LoadPairModel(groups_[group]);
    if (!model.ok()) return model.status();
    return SceneObject{groups_[group], *std::move(model)};
  }
  // T_sensor_model of a detection of `stable_pose`.
  Eigen::Isometry3f SensorModel(const TaughtStablePose& stable_pose,
                                const Pose& world_object) const {
    const Pose object_model = stable_pose.object_mesh.value_or(Pose::Identity());
    return (segmentation_.world_sensor.inverse() * world_object * object_model).cast<float>();
  }
  absl::Status VerifyOne(AnsweredSegment* answer);
  void Claim(const PairModel& model, const Eigen::Isometry3f& sensor_model);
  float ClaimedShare(const PairModel& model, const Eigen::Isometry3f& sensor_model) const;
  bool IsMuchLeft() const;
  std::vector<std::size_t> GroupsToSearch(const std::vector<AnsweredSegment>& answers) const;
  absl::StatusOr<std::optional<AnsweredSegment>> AnswerOf(const SceneObject& object,
                                                          const Proposal& proposal);
  void TakeSegments(const SceneObject& object, const Eigen::Isometry3f& sensor_model,
                    AnsweredSegment* found, std::vector<AnsweredSegment>* answers) const;

  const Scan& scan_;
  const Segmentation& segmentation_;
  const CatalogueSnapshot& catalogue_;
  ViewClouds& clouds_;
  const RecognitionParameters& parameters_;
  const IsCancelled& is_cancelled_;
  const std::vector<StablePoses> groups_;
  std::unordered_map<std::string, std::size_t> group_of_;
  Frame frame_;
  std::unordered_map<std::size_t, SceneObject> objects_;  // by group, of Propose
};

// Calls `visit` with each pixel in the cells under the model's visible points, and its depth and
// that of the point.
template <typename Visit>
void ForEachPixelUnder(const Frame& frame, const PairModel& model,
                       const Eigen::Isometry3f& sensor_model, const Visit& visit) {
  for (const std::uint16_t i : AspectAt(model, sensor_model).visible) {
    const Eigen::Vector3f p = sensor_model * model.surface.points[i];
    const std::ptrdiff_t middle = frame.PixelOf(p);
    if (middle < 0) continue;
    const int middle_u = static_cast<int>(middle) % frame.camera.width;
    const int middle_v = static_cast<int>(middle) / frame.camera.width;
    for (int y = middle_v - kClaimCell / 2; y <= middle_v + kClaimCell / 2; ++y) {
      for (int x = middle_u - kClaimCell / 2; x <= middle_u + kClaimCell / 2; ++x) {
        if (frame.Contains(x, y)) visit(frame.PixelAt(x, y), p.z());
      }
    }
  }
}

absl::Status Scene::Verify(std::vector<AnsweredSegment>* answers) {
  for (AnsweredSegment& answer : *answers) {
    if (answer.detection.view == nullptr) continue;
    if (is_cancelled_()) return absl::CancelledError("cancelled while judging answers");
    if (absl::Status status = VerifyOne(&answer); !status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::Status Scene::VerifyOne(AnsweredSegment* answer) {
  Detection& detection = answer->detection;
  const TaughtStablePose* taught = StablePoseOf(catalogue_, detection);
  if (taught == nullptr) return absl::OkStatus();
  auto object = ObjectAt(group_of_.at(taught->name));
  if (!object.ok()) return object.status();
  if (object->model == nullptr) return absl::OkStatus();
  const SceneParameters& scene = parameters_.scene;
  const Eigen::Isometry3f pose = SensorModel(*taught, detection.refined_pose);
  const SceneHypothesis judged = JudgePose(frame_, *object->model, pose, scene.search);
  const double own = std::clamp(detection.score, kMinConfidence, 1 - kMinConfidence);
  const double log_odds = SceneScore(frame_, judged, scene.search.evidence, kContradictions) +
                          std::log(own / (1 - own));
  const double score = ScoreOf(log_odds - scene.segment_bar);
  if (score < std::min(0.5, MinScore(taught, parameters_.matching))) {
    detection.score = std::min(detection.score, score);
    detection.outcome = RecognitionOutcome::kUnknownObject;
    detection.rejected_by = Gate::kModel;
    detection.view = nullptr;
    detection.grasps.clear();
    detection.equivalent_poses.clear();
    detection.alternatives.clear();
    detection.ambiguous = false;
    return absl::OkStatus();
  }
  Claim(*object->model, pose);
  return absl::OkStatus();
}

void Scene::Claim(const PairModel& model, const Eigen::Isometry3f& sensor_model) {
  ForEachPixelUnder(frame_, model, sensor_model, [&](std::size_t pixel, float z) {
    const bool is_there = std::abs(frame_.depth[pixel] - z) < kClaimM;
    if (is_there && frame_.role[pixel] == PixelRole::kObject) {
      frame_.role[pixel] = PixelRole::kExplained;
    }
  });
}

float Scene::ClaimedShare(const PairModel& model, const Eigen::Isometry3f& sensor_model) const {
  float claimed = 0;
  float there = 0;
  ForEachPixelUnder(frame_, model, sensor_model, [&](std::size_t pixel, float z) {
    if (std::abs(frame_.depth[pixel] - z) >= kClaimM) return;
    claimed += frame_.role[pixel] == PixelRole::kExplained ? 1.0F : 0.0F;
    there += 1;
  });
  return there > 0 ? claimed / there : 1;
}

// Counts blocks of pixels that no answer explains at all: what is left around an explained object
// is its edge.
bool Scene::IsMuchLeft() const {
  constexpr int kBlock = 8;
  const double pixel = 1 / (frame_.camera.fx * frame_.camera.fy);
  double area = 0;
  for (int v = 0; v + kBlock <= frame_.camera.height; v += kBlock) {
    for (int u = 0; u + kBlock <= frame_.camera.width; u += kBlock) {
      double block = 0;
      bool is_open = true;
      for (int y = v; y < v + kBlock && is_open; ++y) {
        for (int x = u; x < u + kBlock; ++x) {
          const std::size_t i = frame_.PixelAt(x, y);
          is_open = is_open && frame_.role[i] != PixelRole::kExplained;
          if (frame_.role[i] != PixelRole::kObject) continue;
          block += pixel * static_cast<double>(frame_.depth[i] * frame_.depth[i]);
        }
      }
      if (is_open) area += block;
    }
  }
  return area >= parameters_.scene.min_area_m2;
}

std::vector<std::size_t> Scene::GroupsToSearch(const std::vector<AnsweredSegment>& answers) const {
  std::vector<std::size_t> out;
  std::unordered_set<std::size_t> taken;
  const auto take = [&](std::size_t group) {
    if (out.size() < parameters_.scene.max_objects && taken.insert(group).second) {
      out.push_back(group);
    }
  };
  if (groups_.size() > parameters_.scene.max_objects) {
    for (const AnsweredSegment& answer : answers) {
      if (answer.detection.view != nullptr) continue;
      for (const Candidate& candidate : answer.detection.candidates) {
        const auto group = group_of_.find(candidate.view->stable_pose);
        if (group != group_of_.end()) take(group->second);
      }
    }
  }
  for (std::size_t g = 0; g < groups_.size(); ++g) take(g);
  return out;
}

absl::StatusOr<std::vector<Proposal>> Scene::Propose(const std::vector<AnsweredSegment>& answers) {
  std::vector<Proposal> out;
  if (!IsMuchLeft()) return out;
  const ObjectSearchParameters& search = parameters_.scene.search;
  std::map<long, OrientedCloud> samples;
  const auto level_of = [](const PairModel& model) {
    return std::lround(std::log(model.step_m / kFinestSampleM) / std::log(kSampleBase));
  };
  std::vector<std::size_t> groups;
  for (const std::size_t group : GroupsToSearch(answers)) {
    auto object = ObjectAt(group);
    if (!object.ok()) return object.status();
    if (object->model == nullptr) continue;
    groups.push_back(group);
    const long level = level_of(*object->model);
    if (!samples.contains(level)) {
      samples[level] =
          SceneSample(frame_, kFinestSampleM * static_cast<float>(std::pow(kSampleBase, level)));
    }
    objects_[group] = *std::move(object);
  }
  std::vector<std::vector<SceneHypothesis>> found(groups.size());
  ForEachIndex(groups.size(), [&](std::size_t i) {
    if (is_cancelled_()) return;
    const PairModel& model = *objects_.at(groups[i]).model;
    found[i] = SearchObject(frame_, samples.at(level_of(model)), model, search, is_cancelled_);
  });
  if (is_cancelled_()) return absl::CancelledError("cancelled while searching for objects");
  for (std::size_t i = 0; i < groups.size(); ++i) {
    for (SceneHypothesis& hypothesis : found[i]) {
      const double log_odds = SceneScore(frame_, hypothesis, search.evidence);
      out.push_back({groups[i], std::move(hypothesis), log_odds});
    }
  }
  std::ranges::stable_sort(out, std::greater(), &Proposal::log_odds);
  return out;
}

// The most likely first; each explains pixels that are then no other's.
absl::Status Scene::Explain(const std::vector<Proposal>& proposals,
                            std::vector<AnsweredSegment>* answers) {
  for (const Proposal& proposal : proposals) {
    if (is_cancelled_()) return absl::CancelledError("cancelled while explaining the scene");
    const SceneObject& object = objects_.at(proposal.object);
    const Eigen::Isometry3f& pose = proposal.hypothesis.sensor_object;
    if (ScoreOf(proposal.log_odds - parameters_.scene.pairs_bar) < parameters_.matching.min_score) {
      break;
    }
    if (ClaimedShare(*object.model, pose) > kMaxClaimed) continue;
    auto answer = AnswerOf(object, proposal);
    if (!answer.ok()) return answer.status();
    if (!*answer) continue;
    TakeSegments(object, pose, &**answer, answers);
    Claim(*object.model, pose);
    answers->push_back(**std::move(answer));
  }
  return absl::OkStatus();
}

// Null where the object cannot stand there, or the score is too low for its stable pose.
absl::StatusOr<std::optional<AnsweredSegment>> Scene::AnswerOf(const SceneObject& object,
                                                               const Proposal& proposal) {
  const SceneHypothesis& h = proposal.hypothesis;
  const Pose world_model = segmentation_.world_sensor * h.sensor_object.cast<double>();
  const TaughtStablePose* stable_pose = nullptr;
  Pose world_object = Pose::Identity();
  for (const auto& other : object.stable_poses) {
    const Pose pose = world_model * other->object_mesh.value_or(Pose::Identity()).inverse();
    if (stable_pose != nullptr && pose.linear()(2, 2) <= world_object.linear()(2, 2)) continue;
    stable_pose = other.get();
    world_object = pose;
  }
  const bool any_orientation = stable_pose->object_mesh.has_value();
  std::optional<AnsweredSegment> none;
  if (!any_orientation && world_object.linear()(2, 2) < std::cos(parameters_.scene.max_tilt_rad)) {
    return none;
  }
  AnsweredSegment out;
  Detection& d = out.detection;
  d.score = ScoreOf(proposal.log_odds - parameters_.scene.pairs_bar);
  if (d.score < MinScore(stable_pose, parameters_.matching)) return none;
  // The view from the most similar direction.
  const auto towards = [](const Pose& world, const Pose& world_sensor) {
    return (world.inverse() * world_sensor.translation()).normalized();
  };
  const Eigen::Vector3d here = towards(world_object, segmentation_.world_sensor);
  d.view = *std::ranges::max_element(stable_pose->views, {}, [&](const auto& view) {
    return towards(view->world_object, view->world_sensor).dot(here);
  });
  auto model = clouds_.LoadModel(*d.view, *stable_pose);
  if (!model.ok()) return model.status();
  d.model = *std::move(model);
  d.rough_pose = world_object;
  d.refined_pose = world_object;
  const SurfaceEvidence& s = h.surface;
  const double measured = std::max(1e-3F, s.seen + s.contradicted + s.table);
  d.evidence = {.scan_explained = s.seen / measured,
                .model_seen = s.seen,
                .unoccluded = 1 - s.hidden,
                .rms_m = s.rms_m,
                .score = h.score,
                .confirmed = s.seen,
                .contradicted = s.contradicted + s.table,
                .unmeasured = s.unmeasured,
                .point_count = s.seen_count};
  d.registration = {.target_source = Pose::Identity(),
                    .converged = true,
                    .iterations = parameters_.scene.search.last_steps.iterations,
                    .rms_error_m = s.rms_m,
                    .inlier_fraction = d.evidence.scan_explained};
  d.point_count = s.seen_count;
  d.centroid = world_model * object.model->center.cast<double>();
  out.segment.centroid = d.centroid;
  CompleteDetection(stable_pose, parameters_.workspace, &d);
  return {std::move(out)};
}

// The segments that lie on a new detection become it; one of which it is a part stays, and both
// touch.
void Scene::TakeSegments(const SceneObject& object, const Eigen::Isometry3f& sensor_model,
                         AnsweredSegment* found, std::vector<AnsweredSegment>* answers) const {
  std::vector<bool> is_on(frame_.depth.size(), false);
  ForEachPixelUnder(frame_, *object.model, sensor_model, [&](std::size_t pixel, float z) {
    if (std::abs(frame_.depth[pixel] - z) < kClaimM) is_on[pixel] = true;
  });
  const Eigen::Isometry3f sensor_world = segmentation_.world_sensor.inverse().cast<float>();
  const auto share_on = [&](const Segment& segment) {
    double on = 0;
    for (const auto& point : segment.cloud.points) {
      const std::ptrdiff_t pixel = frame_.PixelOf(sensor_world * point);
      if (pixel >= 0 && is_on[static_cast<std::size_t>(pixel)]) on += 1;
    }
    return segment.cloud.points.empty() ? 0 : on / static_cast<double>(segment.cloud.points.size());
  };
  std::erase_if(*answers, [&](AnsweredSegment& answer) {
    if (answer.detection.view != nullptr) return false;
    const double share = share_on(answer.segment);
    constexpr double kTouches = 0.05;
    if (share >= kTouches && share < kOwnShare) {
      answer.detection.touching = true;
      found->detection.touching = true;
    }
    if (share < kOwnShare) return false;
    if (found->detection.candidates.empty()) {
      found->detection.candidates = std::move(answer.detection.candidates);
    }
    return true;
  });
}

}  // namespace

absl::Status ExplainScene(const Scan& scan, const Segmentation& segmentation,
                          const CatalogueSnapshot& catalogue, ViewClouds& clouds,
                          const RecognitionParameters& parameters, const IsCancelled& is_cancelled,
                          StageLog* log, std::vector<AnsweredSegment>* answers) {
  if (catalogue.stable_poses == nullptr) return absl::OkStatus();
  Scene scene(scan, segmentation, catalogue, clouds, parameters, is_cancelled);
  std::size_t pixels = 0;
  log->Measure("frame", scan.size(), [&] { return pixels = scene.MakeFrameOfScan(); });
  if (is_cancelled()) return absl::CancelledError("cancelled while making the frame");
  if (pixels == 0) return absl::OkStatus();
  absl::Status status;
  const auto accepted = [&] {
    return static_cast<std::size_t>(std::ranges::count_if(
        *answers, [](const AnsweredSegment& a) { return a.detection.view != nullptr; }));
  };
  log->Measure("verify", accepted(), [&] {
    status = scene.Verify(answers);
    return accepted();
  });
  if (!status.ok()) return status;
  absl::StatusOr<std::vector<Proposal>> proposals;
  log->Measure("propose", pixels, [&] {
    proposals = scene.Propose(*answers);
    return proposals.ok() ? proposals->size() : 0;
  });
  if (!proposals.ok()) return proposals.status();
  log->Measure("explain", proposals->size(), [&] {
    status = scene.Explain(*proposals, answers);
    return accepted();
  });
  return status;
}

}  // namespace graspdb::recognition
