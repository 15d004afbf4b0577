#include "recognition/scene_proposals.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>
#include <unordered_set>

#include "recognition/base/idle_cores.h"
#include "recognition/points/thinned.h"
#include "recognition/scene/explained_clusters.h"
#include "recognition/scene/explained_pixels.h"
#include "recognition/scene/scene_score.h"
#include "recognition/scene_detection.h"
#include "recognition/segment_recognition.h"
#include "recognition/verification/scan_depths.h"

namespace graspdb::recognition {
namespace {

// Cells of the scene's samples, m: the smallest, and how many times as large the next one is.
constexpr float kSmallestCellM = 0.004F;
constexpr float kCellRatio = 1.5F;
// Proposals compete for a place where their centres are nearer than this, and are poses of one
// object there where they are nearer than that; shares of the larger diameter.
constexpr float kRivalShare = 0.35F;
constexpr float kSamePoseShare = 0.05F;

absl::Status CheckNotCancelled(const SceneInput& input) {
  return input.is_cancelled() ? absl::CancelledError("cancelled while explaining the scene")
                              : absl::OkStatus();
}

float CellOf(const PairModel& model) {
  const float level = std::round(std::log(model.step_m / kSmallestCellM) / std::log(kCellRatio));
  return kSmallestCellM * std::pow(kCellRatio, level);
}

// Whether some side must be longer than an object's may be.
bool IsTooLarge(const PairModel& model, const SegmentationParameters& parameters) {
  return model.diameter_m > std::sqrt(3.0) * parameters.max_object_size_m;
}

// Of a large catalogue, those whose views resemble an unexplained segment come first.
std::vector<std::size_t> GroupsToSearch(const std::vector<StablePoses>& groups,
                                        const std::vector<AnsweredSegment>& answers,
                                        std::size_t max_objects) {
  std::unordered_map<std::string, std::size_t> group_of;  // by name of a stable pose
  for (std::size_t g = 0; g < groups.size(); ++g) {
    for (const auto& stable_pose : groups[g]) group_of[stable_pose->name] = g;
  }
  std::vector<std::size_t> out;
  std::unordered_set<std::size_t> taken;
  const auto take = [&](std::size_t group) {
    if (out.size() < max_objects && taken.insert(group).second) out.push_back(group);
  };
  for (const AnsweredSegment& answer : answers) {
    if (answer.detection.view != nullptr) continue;
    for (const Candidate& candidate : answer.detection.candidates) {
      const auto group = group_of.find(candidate.view->stable_pose);
      if (group != group_of.end()) take(group->second);
    }
  }
  for (std::size_t g = 0; g < groups.size(); ++g) take(g);
  return out;
}

// An object that was taught from views alone stands as it was taught, where up is known.
std::optional<Voting::Upright> UprightOf(const SceneInput& input, const StablePoses& stable_poses) {
  if (stable_poses.front()->object_mesh || !input.segmentation.HasGravity()) return std::nullopt;
  // Turns of votes are in bins of 12 degrees.
  constexpr double kVoteRad = 0.2;
  return Voting::Upright{
      input.segmentation.world_sensor.linear().row(2).transpose().cast<float>(),
      static_cast<float>(std::cos(input.parameters.scene.max_tilt_rad + kVoteRad))};
}

// Of each searched object. Those with the same cell share a sample of the scene.
std::vector<VotedPoses> VotedPosesOf(
    const SceneInput& input, const Frame& frame, const std::vector<SceneProposal>& searched,
    const std::map<float, std::vector<std::size_t>>& searched_by_cell) {
  const OrientedCloud shown = ObjectPoints(frame);
  const std::vector<std::pair<float, std::vector<std::size_t>>> groups(searched_by_cell.begin(),
                                                                       searched_by_cell.end());
  std::vector<VotedPoses> out(searched.size());
  ForEachIndex(groups.size(), [&](std::size_t g) {
    const auto& [cell_m, members] = groups[g];
    std::vector<Voting> models;
    for (const std::size_t i : members) {
      models.push_back({searched[i].model.get(), UprightOf(input, searched[i].stable_poses)});
    }
    if (input.is_cancelled()) return;
    std::vector<VotedPoses> voted =
        VoteForPoses(models, ThinnedToCells(shown, cell_m),
                     input.parameters.scene.object_search.votes, input.is_cancelled);
    for (std::size_t m = 0; m < members.size(); ++m) out[members[m]] = std::move(voted[m]);
  });
  return out;
}

// Passes what the search leaves of one object on to the caller's observer.
SearchObserver ObserverOf(const SceneInput& input, const StablePoses& stable_poses) {
  const PoseObserver& observer = input.parameters.matching.observer;
  if (!observer) return {};
  const TaughtStablePose& shown = *stable_poses.front();
  return [&](PoseStep step, std::span<const Eigen::Isometry3f> sensor_model) {
    const Pose model_object = shown.object_mesh.value_or(Pose::Identity()).inverse();
    std::vector<ObservedPose> poses;
    for (const Eigen::Isometry3f& pose : sensor_model) {
      poses.push_back(
          {shown.name, input.segmentation.world_sensor * pose.cast<double>() * model_object});
    }
    observer(step, PoseSource::kImage, poses);
  };
}

// The scan's points that lie on proposals.
class OwnPointsFinder {
 public:
  OwnPointsFinder(const SceneInput& input, const Frame& frame)
      : input_(input), frame_(frame), points_(PointOfPixels(input, frame)) {
    Segment all;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (points_[i] >= 0 && frame.role[i] == PixelRole::kObject) all.indices.push_back(points_[i]);
    }
    depths_ = std::make_unique<const ScanDepths>(input.scan, std::span<const Segment>(&all, 1));
  }

  const ScanDepths& depths() const { return *depths_; }

  Segment On(const Pixels& pixels) const {
    const Pose& world_sensor = input_.segmentation.world_sensor;
    Segment out;
    Points world;
    for (const std::size_t i : pixels) {
      if (frame_.role[i] != PixelRole::kObject || points_[i] < 0) continue;
      out.indices.push_back(points_[i]);
      world.push_back(world_sensor.cast<float>() * frame_.PointAt(i, frame_.depth[i]));
    }
    out.cloud = PrepareCloud(world, world_sensor.translation(), input_.parameters.descriptor);
    out.centroid = Centroid(out.cloud.points);
    return out;
  }

 private:
  // A point of the scan for each pixel of the frame; -1: none.
  static Indices PointOfPixels(const SceneInput& input, const Frame& frame) {
    Indices out(frame.depth.size(), -1);
    for (std::size_t i = 0; i < input.scan.size(); ++i) {
      const Eigen::Vector3f p = input.scan.PointAt(i);
      const std::ptrdiff_t pixel = p.allFinite() ? frame.PixelOf(p) : -1;
      if (pixel >= 0) out[static_cast<std::size_t>(pixel)] = static_cast<std::int32_t>(i);
    }
    return out;
  }

  const SceneInput& input_;
  const Frame& frame_;
  const Indices points_;
  std::unique_ptr<const ScanDepths> depths_;
};

// A pose that was aligned with points of the scan.
struct AlignedPose {
  Detection detection;
  Eigen::Isometry3f sensor_model = Eigen::Isometry3f::Identity();
  SceneHypothesis judged;
};

// A proposal after its alignment.
struct Aligned {
  std::optional<AlignedPose> pose;  // absent: rejected
  float log_odds = 0;               // by the image, the worse of before and after the alignment
  // Without the points of neighbours. Absent where too few are left.
  std::optional<AlignedPose> alone;
};

// `pixels` are those that the proposal explains.
absl::StatusOr<Aligned> Align(const SceneInput& input, const Frame& frame,
                              const OwnPointsFinder& finder, const SceneProposal& proposal,
                              const Pixels& pixels, bool may_explain_cluster) {
  Aligned out;
  const SceneParameters& scene = input.parameters.scene;
  const Segment segment = finder.On(pixels);
  const auto fewest =
      static_cast<std::size_t>(input.parameters.segmentation.min_cluster_point_count);
  if (segment.cloud.points.size() < fewest) return out;
  const OwnPoints own{input.scan, finder.depths(), input.segmentation, segment};
  auto detection = DetectionOf(proposal.hypothesis, proposal.stable_poses, own, input.clouds,
                               input.parameters, input.is_cancelled);
  if (absl::IsDataLoss(detection.status())) return out;  // as in ProposeObjects
  if (!detection.ok()) return detection.status();
  if (!*detection) return out;
  const TaughtStablePose* taught = StablePoseOf(input.catalogue, **detection);
  if (taught == nullptr) return out;
  const auto judged = [&](Detection aligned) {
    const Eigen::Isometry3f sensor_model =
        (input.segmentation.world_sensor.inverse() * aligned.refined_pose *
         taught->object_mesh.value_or(Pose::Identity()))
            .cast<float>();
    return AlignedPose{std::move(aligned), sensor_model,
                       JudgePose(frame, *proposal.model, sensor_model, scene.object_search)};
  };
  if (may_explain_cluster) {
    auto alone = WithoutNeighbours(proposal.hypothesis, **detection, own, input.parameters,
                                   input.is_cancelled);
    if (alone) out.alone = judged(*std::move(alone));
  }
  out.pose = judged(**std::move(detection));
  const ImageEvidenceParameters& evidence = scene.object_search.evidence;
  out.log_odds = std::min(proposal.log_odds, SceneScore(frame, out.pose->judged, evidence));
  return out;
}

ClusterPixels ClustersOf(const SceneInput& input, const Frame& frame,
                         const std::vector<AnsweredSegment>& answers) {
  std::vector<const Indices*> clusters;
  clusters.reserve(answers.size());
  for (const AnsweredSegment& answer : answers) clusters.push_back(&answer.segment.indices);
  return ClusterPixelsOf(input.scan, frame, clusters);
}

// What the proposals explain before they are aligned.
std::vector<Pixels> PixelsOf(const Frame& frame, const std::vector<SceneProposal>& proposals) {
  std::vector<Pixels> out(proposals.size());
  ForEachIndex(proposals.size(), [&](std::size_t i) {
    out[i] = PixelsOn(frame, *proposals[i].model, proposals[i].hypothesis.sensor_object);
  });
  return out;
}

// Proposals that explain a cluster completely, alone or with others.
std::vector<bool> WhichExplainClusters(const SceneInput& input, const Frame& frame,
                                       const ClusterPixels& clusters,
                                       const std::vector<SceneProposal>& proposals,
                                       const std::vector<Aligned>& aligned) {
  std::vector<std::optional<ClusterCandidate>> candidates(aligned.size());
  for (std::size_t i = 0; i < aligned.size(); ++i) {
    const std::optional<AlignedPose>& alone = aligned[i].alone;
    if (!alone || alone->judged.information < input.parameters.scene.clusters.min_information) {
      continue;
    }
    if (alone->detection.score <
        MinScore(StablePoseOf(input.catalogue, alone->detection), input.parameters.matching)) {
      continue;
    }
    candidates[i] = {PixelsOn(frame, *proposals[i].model, alone->sensor_model),
                     alone->detection.score, aligned[i].log_odds};
  }
  return WhichExplainClusters(frame, clusters, candidates, input.parameters.scene.clusters);
}

// How much more likely proposal `i` is than the best other one in its place. Turns of one object
// about its centre do not compete: those of a symmetric one are the same.
float LeadOf(std::size_t i, const std::vector<SceneProposal>& proposals,
             const std::vector<Aligned>& aligned) {
  float rival = kNoRivalLogOdds;
  const PairModel& model = *proposals[i].model;
  const Eigen::Vector3f center = aligned[i].pose->sensor_model * model.center;
  for (std::size_t j = 0; j < proposals.size(); ++j) {
    if (j == i || !aligned[j].pose) continue;
    const PairModel& other = *proposals[j].model;
    const float distance = (aligned[j].pose->sensor_model * other.center - center).norm();
    const float diameter = std::max(model.diameter_m, other.diameter_m);
    if (distance > kRivalShare * diameter) continue;
    if (&model == &other && distance < kSamePoseShare * diameter) continue;
    rival = std::max(rival, aligned[j].log_odds);
  }
  return aligned[i].log_odds - rival;
}

}  // namespace

absl::StatusOr<std::vector<SceneProposal>> ProposeObjects(
    const SceneInput& input, const Frame& frame, const std::vector<AnsweredSegment>& answers) {
  const SceneParameters& scene = input.parameters.scene;
  std::vector<SceneProposal> out;
  if (UnexplainedArea(frame) < scene.min_area_m2) return out;
  const std::vector<StablePoses> groups = PairModelGroups(*input.catalogue.stable_poses);
  const std::vector<std::size_t> order = GroupsToSearch(groups, answers, scene.max_objects);
  std::vector<absl::StatusOr<std::shared_ptr<const PairModel>>> models(order.size(), nullptr);
  ForEachIndex(order.size(), [&](std::size_t i) {
    if (!input.is_cancelled()) models[i] = input.clouds.LoadPairModel(groups[order[i]]);
  });
  if (absl::Status status = CheckNotCancelled(input); !status.ok()) return status;
  std::vector<SceneProposal> searched;                         // an object each
  std::map<float, std::vector<std::size_t>> searched_by_cell;  // the finest first
  for (std::size_t i = 0; i < order.size(); ++i) {
    auto& model = models[i];
    // One object whose clouds are damaged keeps no other from being found.
    if (absl::IsDataLoss(model.status())) continue;
    if (!model.ok()) return model.status();
    if (*model == nullptr || IsTooLarge(**model, input.parameters.segmentation)) continue;
    searched_by_cell[CellOf(**model)].push_back(searched.size());
    searched.push_back({groups[order[i]], *std::move(model), {}});
  }
  const std::vector<VotedPoses> voted = VotedPosesOf(input, frame, searched, searched_by_cell);
  std::vector<std::vector<SceneHypothesis>> found(searched.size());
  ForEachIndex(searched.size(), [&](std::size_t i) {
    if (input.is_cancelled()) return;
    found[i] = SearchObject(frame, *searched[i].model, voted[i], scene.object_search,
                            input.is_cancelled, ObserverOf(input, searched[i].stable_poses));
  });
  if (absl::Status status = CheckNotCancelled(input); !status.ok()) return status;
  for (std::size_t i = 0; i < searched.size(); ++i) {
    for (const SceneHypothesis& hypothesis : found[i]) {
      const float log_odds = SceneScore(frame, hypothesis, scene.object_search.evidence);
      if (log_odds < scene.min_proposal_log_odds) continue;
      out.push_back({searched[i].stable_poses, searched[i].model, hypothesis, log_odds});
    }
  }
  std::ranges::stable_sort(out, std::greater(), &SceneProposal::log_odds);
  if (out.size() > scene.max_proposals) out.resize(scene.max_proposals);
  return out;
}

double AnswerScore(const Frame& frame, const SceneHypothesis& judged, double own,
                   const SceneParameters& scene) {
  // No confidence in an answer is nearer to 0 or 1.
  constexpr double kMinConfidence = 0.015;
  own = std::clamp(own, kMinConfidence, 1 - kMinConfidence);
  const ImageEvidenceParameters& evidence = scene.object_search.evidence;
  const double unlikely = std::min(0.0F, SceneScore(frame, judged, evidence));
  const double log_odds = SceneScore(frame, judged, evidence, kContradictions) +
                          scene.unlikely_weight * unlikely + std::log(own / (1 - own)) -
                          scene.segment_bar;
  return 1 / (1 + std::exp(-log_odds));
}

absl::Status ConfirmProposals(const SceneInput& input, const Frame& frame,
                              const std::vector<AnsweredSegment>& answers,
                              std::vector<SceneProposal>* proposals) {
  if (proposals->empty()) return absl::OkStatus();
  const SceneParameters& scene = input.parameters.scene;
  const ClusterPixels clusters = ClustersOf(input, frame, answers);
  const std::vector<Pixels> pixels = PixelsOf(frame, *proposals);
  const std::vector<bool> is_covered =
      CoveredClusters(frame, clusters, pixels, scene.clusters.min_proposed);
  const OwnPointsFinder finder(input, frame);
  std::vector<absl::StatusOr<Aligned>> done(proposals->size(), Aligned());
  ForEachIndex(proposals->size(), [&](std::size_t i) {
    const SceneProposal& proposal = (*proposals)[i];
    const bool is_unlikely = proposal.log_odds < scene.min_log_odds;
    const bool may_explain_cluster = std::ranges::any_of(pixels[i], [&](std::size_t pixel) {
      const int cluster = clusters.cluster_of[pixel];
      return cluster >= 0 && is_covered[static_cast<std::size_t>(cluster)];
    });
    if (input.is_cancelled() || (is_unlikely && !may_explain_cluster)) return;
    done[i] = Align(input, frame, finder, proposal, pixels[i], may_explain_cluster);
  });
  if (absl::Status status = CheckNotCancelled(input); !status.ok()) return status;
  std::vector<Aligned> aligned;
  for (absl::StatusOr<Aligned>& one : done) {
    if (!one.ok()) return one.status();
    aligned.push_back(*std::move(one));
  }
  const std::vector<bool> completes =
      WhichExplainClusters(input, frame, clusters, *proposals, aligned);
  for (std::size_t i = 0; i < aligned.size(); ++i) {
    if (!aligned[i].pose) continue;
    SceneProposal& proposal = (*proposals)[i];
    const AlignedPose& pose = *aligned[i].pose;
    const double by_itself = std::min(
        pose.detection.score, ProposalScore(aligned[i].log_odds, LeadOf(i, *proposals, aligned),
                                            pose.judged.surface.seen_area_m2, scene.proposal));
    const double own = completes[i] ? aligned[i].alone->detection.score : 0;
    const double together =
        completes[i] ? std::min(own, AnswerScore(frame, aligned[i].alone->judged, own, scene)) : 0;
    const AlignedPose& taken = together > by_itself ? *aligned[i].alone : pose;
    proposal.sensor_model = taken.sensor_model;
    proposal.detection = taken.detection;
    proposal.detection.score = std::max(together, by_itself);
  }
  const MatchingParameters& matching = input.parameters.matching;
  std::erase_if(*proposals, [&](const SceneProposal& p) {
    const Detection& d = p.detection;
    return d.view == nullptr || d.score < MinScore(StablePoseOf(input.catalogue, d), matching) ||
           d.evidence.scan_explained < matching.min_inlier_fraction;
  });
  std::ranges::stable_sort(*proposals, std::greater(),
                           [](const SceneProposal& p) { return p.detection.score; });
  return absl::OkStatus();
}

}  // namespace graspdb::recognition
