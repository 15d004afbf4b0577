#include "recognition/scene_answers.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <unordered_map>
#include <unordered_set>

#include "recognition/base/idle_cores.h"
#include "recognition/scene/explained_pixels.h"
#include "recognition/scene/scene_score.h"
#include "recognition/scene_detection.h"
#include "recognition/segment_recognition.h"
#include "recognition/segmentation/region.h"

namespace graspdb::recognition {
namespace {

// A proposal may share so many of its pixels with answers.
constexpr double kMaxExplainedShare = 0.3;
// A segment is a new detection's where so many of its points lie on it, and touches it where fewer
// do.
constexpr double kOwnShare = 0.6;
constexpr double kTouchingShare = 0.05;
// No confidence in an answer is nearer to 0 or 1.
constexpr double kMinConfidence = 0.015;
// Cells of the scene's samples, m: the smallest, and how many times as large the next one is.
constexpr float kSmallestCellM = 0.004F;
constexpr float kCellRatio = 1.5F;

double ScoreOf(double log_odds) { return 1 / (1 + std::exp(-log_odds)); }

// A pose of an object that the frame may show.
struct Proposal {
  std::size_t group = 0;  // of stable poses
  std::shared_ptr<const PairModel> model;
  SceneHypothesis hypothesis;
  double score = 0;
};

void Reject(double score, Detection* detection) {
  detection->score = std::min(detection->score, score);
  detection->outcome = RecognitionOutcome::kUnknownObject;
  detection->rejected_by = Gate::kModel;
  detection->view = nullptr;
  detection->grasps.clear();
  detection->equivalent_poses.clear();
  detection->alternatives.clear();
  detection->ambiguous = false;
}

class Scene {
 public:
  Scene(const Scan& scan, const Segmentation& segmentation, const CatalogueSnapshot& catalogue,
        ViewClouds& clouds, const RecognitionParameters& parameters,
        const IsCancelled& is_cancelled, const Points& of_interest)
      : world_sensor_(segmentation.world_sensor),
        catalogue_(catalogue),
        clouds_(clouds),
        parameters_(parameters),
        is_cancelled_(is_cancelled),
        groups_(parameters.scene.search ? PairModelGroups(*catalogue.stable_poses)
                                        : std::vector<StablePoses>()),
        frame_(MakeFrame(scan, world_sensor_, segmentation.table,
                         scan.region.value_or(DefaultRegion(world_sensor_)), parameters.scene.frame,
                         is_cancelled, of_interest)) {
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      for (const auto& stable_pose : groups_[g]) group_of_[stable_pose->name] = g;
    }
  }

  // Whether the scan is no image that a camera could have taken.
  bool is_empty() const { return frame_.depth.empty(); }
  std::size_t object_pixels() const {
    return static_cast<std::size_t>(std::ranges::count(frame_.role, PixelRole::kObject));
  }
  absl::Status Verify(std::vector<AnsweredSegment>* answers);
  // The most likely first.
  absl::StatusOr<std::vector<Proposal>> Propose(const std::vector<AnsweredSegment>& answers) const;
  absl::Status Explain(const std::vector<Proposal>& proposals,
                       std::vector<AnsweredSegment>* answers);

 private:
  void VerifyOne(Detection* detection);
  absl::Status CheckNotCancelled() const {
    return is_cancelled_() ? absl::CancelledError("cancelled while explaining the scene")
                           : absl::OkStatus();
  }
  std::vector<std::size_t> GroupsToSearch(const std::vector<AnsweredSegment>& answers) const;
  double ShareOn(const std::vector<bool>& pixels, const Segment& segment) const;
  void TakeSegments(const std::vector<bool>& pixels, Detection* found,
                    std::vector<AnsweredSegment>* answers) const;

  const Pose world_sensor_;
  const CatalogueSnapshot& catalogue_;
  ViewClouds& clouds_;
  const RecognitionParameters& parameters_;
  const IsCancelled& is_cancelled_;
  const std::vector<StablePoses> groups_;                  // empty without a search
  std::unordered_map<std::string, std::size_t> group_of_;  // by name of a stable pose
  Frame frame_;
};

absl::Status Scene::Verify(std::vector<AnsweredSegment>* answers) {
  for (AnsweredSegment& answer : *answers) {
    if (answer.detection.view == nullptr) continue;
    if (absl::Status status = CheckNotCancelled(); !status.ok()) return status;
    VerifyOne(&answer.detection);
  }
  return absl::OkStatus();
}

void Scene::VerifyOne(Detection* detection) {
  if (detection->model == nullptr) return;
  const SceneParameters& scene = parameters_.scene;
  const ImageModel model = MakeImageModel(detection->model->fine.cloud, {});
  const Eigen::Isometry3f sensor_object =
      (world_sensor_.inverse() * detection->refined_pose).cast<float>();
  const SceneHypothesis judged = JudgePose(frame_, model, sensor_object, scene.object_search);
  const double own = std::clamp(detection->score, kMinConfidence, 1 - kMinConfidence);
  const double score =
      ScoreOf(SceneScore(frame_, judged, scene.object_search.evidence, kContradictions) +
              std::log(own / (1 - own)) - scene.segment_bar);
  const double min_score = MinScore(StablePoseOf(catalogue_, *detection), parameters_.matching);
  if (score < std::min(0.5, min_score)) {
    Reject(score, detection);
  } else {
    recognition::Explain(PixelsOn(frame_, model, sensor_object), &frame_);
  }
}

// Of a large catalogue, those whose views resemble an unexplained segment come first.
std::vector<std::size_t> Scene::GroupsToSearch(const std::vector<AnsweredSegment>& answers) const {
  std::vector<std::size_t> out;
  std::unordered_set<std::size_t> taken;
  const auto take = [&](std::size_t group) {
    if (out.size() < parameters_.scene.max_objects && taken.insert(group).second) {
      out.push_back(group);
    }
  };
  for (const AnsweredSegment& answer : answers) {
    if (answer.detection.view != nullptr) continue;
    for (const Candidate& candidate : answer.detection.candidates) {
      const auto group = group_of_.find(candidate.view->stable_pose);
      if (group != group_of_.end()) take(group->second);
    }
  }
  for (std::size_t g = 0; g < groups_.size(); ++g) take(g);
  return out;
}

absl::StatusOr<std::vector<Proposal>> Scene::Propose(
    const std::vector<AnsweredSegment>& answers) const {
  const SceneParameters& scene = parameters_.scene;
  std::vector<Proposal> out;
  if (UnexplainedArea(frame_) < scene.min_area_m2) return out;
  const auto cell_of = [](const PairModel& model) {
    const float level = std::round(std::log(model.step_m / kSmallestCellM) / std::log(kCellRatio));
    return kSmallestCellM * std::pow(kCellRatio, level);
  };
  std::vector<Proposal> searched;          // an object each
  std::map<float, OrientedCloud> samples;  // by cell
  for (const std::size_t group : GroupsToSearch(answers)) {
    auto model = clouds_.LoadPairModel(groups_[group]);
    if (!model.ok()) return model.status();
    if (*model == nullptr) continue;
    const float cell_m = cell_of(**model);
    if (!samples.contains(cell_m)) samples[cell_m] = SceneSample(frame_, cell_m);
    searched.push_back({group, *std::move(model), {}});
  }
  std::vector<std::vector<SceneHypothesis>> found(searched.size());
  ForEachIndex(searched.size(), [&](std::size_t i) {
    if (is_cancelled_()) return;
    const PairModel& model = *searched[i].model;
    found[i] =
        SearchObject(frame_, samples.at(cell_of(model)), model, scene.object_search, is_cancelled_);
  });
  if (absl::Status status = CheckNotCancelled(); !status.ok()) return status;
  for (std::size_t i = 0; i < searched.size(); ++i) {
    for (const SceneHypothesis& hypothesis : found[i]) {
      const double log_odds = SceneScore(frame_, hypothesis, scene.object_search.evidence);
      out.push_back(
          {searched[i].group, searched[i].model, hypothesis, ScoreOf(log_odds - scene.pairs_bar)});
    }
  }
  std::ranges::stable_sort(out, std::greater(), &Proposal::score);
  return out;
}

// Each accepted proposal explains pixels that are then no other's.
absl::Status Scene::Explain(const std::vector<Proposal>& proposals,
                            std::vector<AnsweredSegment>* answers) {
  for (const Proposal& proposal : proposals) {
    if (absl::Status status = CheckNotCancelled(); !status.ok()) return status;
    const std::vector<bool> pixels =
        PixelsOn(frame_, *proposal.model, proposal.hypothesis.sensor_object);
    if (ExplainedShare(frame_, pixels) > kMaxExplainedShare) continue;
    auto detection = DetectionOf(proposal.hypothesis, proposal.score, *proposal.model,
                                 groups_[proposal.group], world_sensor_, clouds_, parameters_);
    if (!detection.ok()) return detection.status();
    if (!*detection) continue;
    TakeSegments(pixels, &**detection, answers);
    recognition::Explain(pixels, &frame_);
    AnsweredSegment answer;
    answer.segment.centroid = (*detection)->centroid;
    answer.detection = **std::move(detection);
    answers->push_back(std::move(answer));
  }
  return absl::OkStatus();
}

double Scene::ShareOn(const std::vector<bool>& pixels, const Segment& segment) const {
  if (segment.cloud.points.empty()) return 0;
  const Eigen::Isometry3f sensor_world = world_sensor_.inverse().cast<float>();
  const auto is_on = [&](const Eigen::Vector3f& p) {
    const std::ptrdiff_t pixel = frame_.PixelOf(sensor_world * p);
    return pixel >= 0 && pixels[static_cast<std::size_t>(pixel)];
  };
  return static_cast<double>(std::ranges::count_if(segment.cloud.points, is_on)) /
         static_cast<double>(segment.cloud.points.size());
}

// Unknown segments that lie on a new detection are removed. One that lies there in part touches it.
void Scene::TakeSegments(const std::vector<bool>& pixels, Detection* found,
                         std::vector<AnsweredSegment>* answers) const {
  std::erase_if(*answers, [&](AnsweredSegment& answer) {
    if (answer.detection.view != nullptr) return false;
    const double share = ShareOn(pixels, answer.segment);
    if (share < kOwnShare) {
      const bool touches = share >= kTouchingShare;
      answer.detection.touching = answer.detection.touching || touches;
      found->touching = found->touching || touches;
      return false;
    }
    if (found->candidates.empty()) found->candidates = std::move(answer.detection.candidates);
    return true;
  });
}

std::size_t AcceptedCount(const std::vector<AnsweredSegment>& answers) {
  return static_cast<std::size_t>(std::ranges::count_if(
      answers, [](const AnsweredSegment& a) { return a.detection.view != nullptr; }));
}

// Sensor frame.
Points AcceptedPoints(const std::vector<AnsweredSegment>& answers, const Pose& world_sensor) {
  const Eigen::Isometry3f sensor_world = world_sensor.inverse().cast<float>();
  Points out;
  for (const AnsweredSegment& answer : answers) {
    if (answer.detection.view == nullptr) continue;
    for (const auto& p : answer.segment.cloud.points) out.push_back(sensor_world * p);
  }
  return out;
}

}  // namespace

absl::Status ExplainScene(const Scan& scan, const Segmentation& segmentation,
                          const CatalogueSnapshot& catalogue, ViewClouds& clouds,
                          const RecognitionParameters& parameters, const IsCancelled& is_cancelled,
                          StageLog* log, std::vector<AnsweredSegment>* answers) {
  if (catalogue.stable_poses == nullptr) return absl::OkStatus();
  const bool search = parameters.scene.search;
  if (!search && AcceptedCount(*answers) == 0) return absl::OkStatus();
  std::optional<Scene> scene;
  log->Measure("frame", scan.size(), [&] {
    scene.emplace(scan, segmentation, catalogue, clouds, parameters, is_cancelled,
                  search ? Points() : AcceptedPoints(*answers, segmentation.world_sensor));
    return scene->object_pixels();
  });
  if (is_cancelled()) return absl::CancelledError("cancelled while making the frame");
  if (scene->is_empty()) return absl::OkStatus();
  absl::Status status;
  if (parameters.scene.verify) {
    log->Measure("verify", AcceptedCount(*answers), [&] {
      status = scene->Verify(answers);
      return AcceptedCount(*answers);
    });
  }
  if (!status.ok() || !search) return status;
  absl::StatusOr<std::vector<Proposal>> proposals;
  log->Measure("propose", scene->object_pixels(), [&] {
    proposals = scene->Propose(*answers);
    return proposals.ok() ? proposals->size() : 0;
  });
  if (!proposals.ok()) return proposals.status();
  log->Measure("explain", proposals->size(), [&] {
    status = scene->Explain(*proposals, answers);
    return AcceptedCount(*answers);
  });
  return status;
}

}  // namespace graspdb::recognition
