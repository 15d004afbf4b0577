#include "recognition/threshold_proposals.h"

#include <algorithm>
#include <map>
#include <unordered_set>
#include <utility>

#include "absl/status/status.h"

namespace graspdb::recognition {
namespace {

// Views of a stable pose that are evaluated.
constexpr std::size_t kEvaluatedViews = 8;
// One of this many right answers may score lower than `right_score`.
constexpr std::size_t kLowOneOf = 8;
constexpr double kLowest = 0.1;
// Only thresholds lower than this share of the usual one are proposed.
constexpr double kWorthwhile = 0.9;

using ViewPtr = std::shared_ptr<const TaughtView>;

// Clouds and models, with those of one stable pose made anew: a model without one view is used once
// and not worth a place in a cache. For one thread.
class WithoutOne : public ViewClouds {
 public:
  WithoutOne(ViewClouds& all, std::string stable_pose)
      : all_(all), stable_pose_(std::move(stable_pose)) {}

  absl::StatusOr<std::shared_ptr<const OrientedCloud>> Load(const TaughtView& view) override {
    return all_.Load(view);
  }

  absl::StatusOr<std::shared_ptr<const SurfaceModel>> LoadModel(
      const TaughtView& view, const TaughtStablePose& stable_pose) override {
    if (stable_pose.name != stable_pose_) return all_.LoadModel(view, stable_pose);
    // Views that share a frame have one model.
    auto& known = models_[view.shares_frame ? "" : view.name];
    if (known) return known;
    auto model = FuseModel(view, stable_pose, all_);
    if (model.ok()) known = *model;
    return model;
  }

 private:
  ViewClouds& all_;
  const std::string stable_pose_;
  std::map<std::string, std::shared_ptr<const SurfaceModel>> models_;
};

// The catalogue without these views.
CatalogueSnapshot Without(const CatalogueSnapshot& catalogue, std::span<const ViewPtr> views) {
  std::unordered_set<std::string> names;
  auto poses = *catalogue.stable_poses;
  for (const ViewPtr& view : views) {
    names.insert(view->name);
    auto& pose = poses.at(view->stable_pose);
    auto rest = std::make_shared<TaughtStablePose>(*pose);
    std::erase(rest->views, view);
    pose = std::move(rest);
  }
  return {catalogue.revision, catalogue.index.Without(names),
          std::make_shared<
              const std::unordered_map<std::string, std::shared_ptr<const TaughtStablePose>>>(
              std::move(poses))};
}

// The object as the view's camera saw it.
absl::StatusOr<Scan> ScanOf(const TaughtView& view, ViewClouds& clouds) {
  auto cloud = clouds.Load(view);
  if (!cloud.ok()) return cloud.status();
  Scan out{.points = Transform(view.world_sensor.inverse(), (*cloud)->points),
           .world_sensor = view.world_sensor,
           .region = std::nullopt,
           .segmented = true};
  // Gravity is unknown.
  if (view.world_sensor.isApprox(Pose::Identity())) out.world_sensor.reset();
  return out;
}

struct Scores {
  ThresholdProposal proposal;
  std::vector<double> right;
};

class LeaveOutEvaluation {
 public:
  LeaveOutEvaluation(const CatalogueSnapshot& catalogue, ViewClouds& clouds,
                     const RecognitionParameters& parameters, const IsCancelled& is_cancelled)
      : catalogue_(catalogue),
        clouds_(clouds),
        parameters_(parameters),
        is_cancelled_(is_cancelled) {
    parameters_.matching.min_score = 0;
    parameters_.matching.use_own_min_scores = false;
    for (const auto& [name, pose] : *catalogue.stable_poses) {
      scores_[name].proposal.stable_pose = name;
      for (const ViewPtr& view : pose->views) of_object_[view->object].push_back(view);
    }
  }

  // Recognises the view while it is left out.
  absl::Status EvaluateKnown(const ViewPtr& view) {
    const auto answer = Best(*view, Without(catalogue_, std::span(&view, 1)));
    if (!answer.ok()) return answer.status();
    Scores& its = scores_.at(view->stable_pose);
    ++its.proposal.query_views;
    if (answer->view && answer->view->stable_pose == view->stable_pose) {
      ++its.proposal.right_views;
      its.right.push_back(answer->score);
    } else {
      RecordWrong(*answer, *view);
    }
    return absl::OkStatus();
  }

  // Recognises the view while its object is left out.
  absl::Status EvaluateUnknown(const ViewPtr& view) {
    const auto answer = Best(*view, Without(catalogue_, of_object_.at(view->object)));
    if (!answer.ok()) return answer.status();
    RecordWrong(*answer, *view);
    return absl::OkStatus();
  }

  // Of the stable poses with views from EvaluateKnown, by name.
  std::vector<ThresholdProposal> Conclude(double usual) {
    std::vector<ThresholdProposal> out;
    for (auto& [name, its] : scores_) {
      ThresholdProposal& proposal = its.proposal;
      if (proposal.query_views == 0) continue;
      if (!its.right.empty()) {
        std::ranges::sort(its.right);
        proposal.right_score = its.right[its.right.size() / kLowOneOf];
      }
      const double between = ThresholdBetween(proposal.right_score, proposal.wrong_score, usual);
      if (between < kWorthwhile * usual) proposal.min_score = between;
      out.push_back(std::move(proposal));
    }
    return out;
  }

 private:
  // Records `answer` as wrong for `view`.
  void RecordWrong(const Detection& answer, const TaughtView& view) {
    if (!answer.view) return;
    ThresholdProposal& named = scores_.at(answer.view->stable_pose).proposal;
    if (answer.score <= named.wrong_score.value_or(-1)) return;
    named.wrong_score = answer.score;
    named.wrong_view = view.name;
  }

  absl::StatusOr<Detection> Best(const TaughtView& view, const CatalogueSnapshot& known) {
    const auto scan = ScanOf(view, clouds_);
    if (!scan.ok()) return scan.status();
    WithoutOne clouds(clouds_, view.stable_pose);
    auto answer = Recognize(*scan, known, clouds, parameters_, is_cancelled_);
    if (!answer.ok()) return answer.status();
    return answer->detections.empty() ? Detection() : std::move(answer->detections.front());
  }

  const CatalogueSnapshot& catalogue_;
  ViewClouds& clouds_;
  RecognitionParameters parameters_;
  const IsCancelled& is_cancelled_;
  std::map<std::string, std::vector<ViewPtr>> of_object_;
  std::map<std::string, Scores> scores_;
};

// Some of the views, from all around, of every stable pose; by name.
std::vector<ViewPtr> Sample(const CatalogueSnapshot& catalogue) {
  std::map<std::string, std::shared_ptr<const TaughtStablePose>> by_name(
      catalogue.stable_poses->begin(), catalogue.stable_poses->end());
  std::vector<ViewPtr> out;
  for (const auto& [name, pose] : by_name) {
    const std::size_t count = std::min(kEvaluatedViews, pose->views.size());
    for (std::size_t i = 0; i < count; ++i) {
      out.push_back(pose->views[i * pose->views.size() / count]);
    }
  }
  return out;
}

}  // namespace

double ThresholdBetween(std::optional<double> right, std::optional<double> wrong, double usual) {
  const double low = wrong.value_or(0);
  if (!right || *right <= low) return usual;
  return std::min(usual, std::max(kLowest, (low + *right) / 2));
}

absl::StatusOr<std::vector<ThresholdProposal>> ProposeThresholds(
    const CatalogueSnapshot& catalogue, ViewClouds& clouds, const std::string& object,
    const RecognitionParameters& parameters, const IsCancelled& is_cancelled,
    const ThresholdProgress& report) {
  LeaveOutEvaluation evaluation(catalogue, clouds, parameters, is_cancelled);
  const std::vector<ViewPtr> views = Sample(catalogue);
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (absl::Status status = report(i, views.size()); !status.ok()) return status;
    const bool is_its = views[i]->object == object;
    absl::Status status = absl::OkStatus();
    if (object.empty() || is_its) status.Update(evaluation.EvaluateKnown(views[i]));
    if (object.empty() || !is_its) status.Update(evaluation.EvaluateUnknown(views[i]));
    if (!status.ok()) return status;
  }
  return evaluation.Conclude(parameters.matching.min_score);
}

}  // namespace graspdb::recognition
