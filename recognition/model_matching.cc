#include "recognition/model_matching.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_set>

#include "absl/status/status.h"
#include "recognition/refinement.h"
#include "recognition/rough_pose.h"

namespace graspdb::recognition {
namespace {

using Views = std::vector<std::shared_ptr<const TaughtView>>;

// Points of the segment that first looks are taken with.
constexpr std::size_t kRoughPoints = 200;
// Hypotheses that are refined in full.
constexpr std::size_t kFinalists = 8;
// A hypothesis with this score needs no other to be asked for.
constexpr double kExplained = 0.94;
// Poses nearer than this are one.
constexpr double kSamePlaceM = 0.004;
constexpr double kSameTurnRad = 4 * std::numbers::pi / 180;
// Look-ups over the segment: cells, and how far they reach, m.
constexpr float kCellM = 0.003F;
constexpr float kReachM = 0.021F;

struct Work {
  PoseHypothesis hypothesis;
  std::shared_ptr<const SurfaceModel> model;
};

bool IsSame(const Work& a, const Work& b) {
  if (a.model != b.model) return false;
  const Pose difference = a.hypothesis.refined.inverse() * b.hypothesis.refined;
  const Eigen::Vector3d center = a.model->center.cast<double>();
  return (difference * center - center).norm() < kSamePlaceM &&
         std::abs(Eigen::AngleAxisd(difference.linear()).angle()) < kSameTurnRad;
}

// The `count` best, the best first, without those that are the same as a better one.
void KeepBest(std::size_t count, std::vector<Work>* works) {
  std::stable_sort(works->begin(), works->end(), [](const Work& a, const Work& b) {
    return a.hypothesis.evidence.score > b.hypothesis.evidence.score;
  });
  std::vector<Work> different;
  for (Work& work : *works) {
    const auto same = [&](const Work& other) { return IsSame(work, other); };
    if (std::any_of(different.begin(), different.end(), same)) continue;
    different.push_back(std::move(work));
    if (different.size() == count) break;
  }
  *works = std::move(different);
}

// Aligns models with one segment.
class Matcher {
 public:
  Matcher(const MatchingInput& input, const CatalogueSnapshot& catalogue, ViewClouds& clouds,
          const MatchingParameters& parameters, const IsCancelled& is_cancelled)
      : input_(input),
        catalogue_(catalogue),
        clouds_(clouds),
        parameters_(parameters),
        is_cancelled_(is_cancelled),
        sight_(input.scan, input.segmentation.world_sensor, input.segment),
        grid_(input.segment.cloud.points, kCellM, kReachM),
        target_{input.segment.cloud, grid_, sight_,
                input.segmentation.world_frame != WorldFrame::kSensor},
        seen_(ExtentOf(input.segment.cloud.points, sight_.sensor_world())),
        stride_(static_cast<int>(
            std::max<std::size_t>(1, input.segment.cloud.points.size() / kRoughPoints))) {}

  // Rough hypotheses from these views, refined, the best ones kept.
  absl::Status Propose(const Views& views) {
    for (const auto& view : views) {
      if (is_cancelled_()) return absl::CancelledError("cancelled while models were aligned");
      const auto pose = catalogue_.stable_poses->find(view->stable_pose);
      if (pose == catalogue_.stable_poses->end()) continue;
      auto model = clouds_.LoadModel(*view, *pose->second);
      if (!model.ok()) return model.status();
      if (*model != nullptr) Try(view, *model);
    }
    KeepBest(kFinalists, &works_);
    for (Work& work : works_) Finish(&work);
    KeepBest(kFinalists, &works_);
    return absl::OkStatus();
  }

  bool IsExplained() const {
    const Sight::Sides& hidden = sight_.hidden_sides();
    return !works_.empty() && works_.front().hypothesis.evidence.score >= kExplained &&
           !(hidden.left || hidden.right || hidden.top || hidden.bottom);
  }

  std::vector<PoseHypothesis> TakeHypotheses() {
    std::vector<PoseHypothesis> out;
    out.reserve(works_.size());
    for (Work& work : works_) out.push_back(std::move(work.hypothesis));
    return out;
  }

 private:
  void Try(const std::shared_ptr<const TaughtView>& view,
           const std::shared_ptr<const SurfaceModel>& model) {
    for (const Pose& rough : RoughPoses(*view, *model, input_.segmentation.world_sensor,
                                        input_.segment.centroid, seen_, sight_)) {
      Work work;
      work.model = model;
      work.hypothesis.view = view;
      work.hypothesis.rough = rough;
      work.hypothesis.refined = Refine(*model, target_, rough,
                                       {.iterations = 6,
                                        .first_reach_m = 0.02,
                                        .last_reach_m = 0.008,
                                        .stride = stride_,
                                        .coarse = true,
                                        .height_deviation_m = 1e-4,
                                        .tilt_deviation_rad = 1e-3})
                                    .world_object;
      work.hypothesis.evidence = Verify(*model, work.hypothesis.refined, input_.segment, sight_,
                                        {parameters_.support_distance_m, stride_, /*coarse=*/true});
      works_.push_back(std::move(work));
    }
  }

  void Finish(Work* work) const {
    PoseHypothesis& h = work->hypothesis;
    const Refinement refinement = Refine(*work->model, target_, h.refined, {});
    h.refined = refinement.world_object;
    h.iterations = refinement.iterations;
    h.evidence = Verify(*work->model, h.refined, input_.segment, sight_,
                        {.tolerance_m = parameters_.support_distance_m});
  }

  const MatchingInput& input_;
  const CatalogueSnapshot& catalogue_;
  ViewClouds& clouds_;
  const MatchingParameters& parameters_;
  const IsCancelled& is_cancelled_;
  const Sight sight_;
  const NearestGrid grid_;
  const RefinementTarget target_;
  const Extent seen_;
  const int stride_;
  std::vector<Work> works_;
};

// All views but those of `nearest`, in the order of their names.
Views OtherViews(const CatalogueSnapshot& catalogue, std::span<const Match> nearest) {
  std::unordered_set<const TaughtView*> known;
  for (const Match& match : nearest) known.insert(match.view.get());
  Views out;
  for (const auto& [name, pose] : *catalogue.stable_poses) {
    for (const auto& view : pose->views) {
      if (!known.contains(view.get())) out.push_back(view);
    }
  }
  std::ranges::sort(out, {}, [](const auto& view) { return view->name; });
  return out;
}

}  // namespace

absl::StatusOr<std::vector<PoseHypothesis>> MatchModels(
    const MatchingInput& input, std::span<const Match> nearest, const CatalogueSnapshot& catalogue,
    ViewClouds& clouds, const MatchingParameters& parameters, const IsCancelled& is_cancelled) {
  Matcher matcher(input, catalogue, clouds, parameters, is_cancelled);
  Views views;
  for (const Match& match : nearest) views.push_back(match.view);
  if (absl::Status status = matcher.Propose(views); !status.ok()) return status;
  if (!matcher.IsExplained()) {
    absl::Status status = matcher.Propose(OtherViews(catalogue, nearest));
    if (!status.ok()) return status;
  }
  return matcher.TakeHypotheses();
}

}  // namespace graspdb::recognition
