// What the image adds to the answers of segments.
#include "recognition/scene_answers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <mutex>

#include "recognition/scene/scene_score.h"
#include "tests/recognition/scenes/taught_shapes.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::recognition {
namespace {

using ::graspdb::testing::IsOk;
using ::graspdb::testing::LargestCornerError;
using ::graspdb::testing::Solid;
using ::graspdb::testing::TaughtShapes;

// Something that was never taught.
Solid Unknown(double x, double y, double height) {
  Solid out;
  out.world_solid.translation() = Eigen::Vector3d(x, y, 0);
  out.boxes = {{{-0.05, -0.05, 0}, {0.05, 0.05, height}},
               {{-0.02, -0.07, 0}, {0.02, -0.05, 0.7 * height}}};
  return out;
}

class SceneAnswersTest : public ::testing::Test {
 protected:
  // The answers must not depend on how busy the machine is.
  SceneAnswersTest() { parameters_.matching.search_ceiling_s = 600; }
  static Scan See(const std::vector<Solid>& parts) { return TaughtShapes::SeeFinely(parts); }
  absl::StatusOr<Recognition> Run(const Scan& scan) {
    return Recognize(scan, taught_.snapshot(), taught_, parameters_, [] { return false; });
  }
  static const Detection* Accepted(const Recognition& recognition, const std::string& object) {
    for (const Detection& d : recognition.detections) {
      if (d.view && d.view->object == "objects/" + object) return &d;
    }
    return nullptr;
  }
  SceneHypothesis JudgeAt(const Scan& scan, const std::string& object, const Pose& world_object) {
    const auto& pose =
        taught_.snapshot().stable_poses->at("objects/" + object + "/stablePoses/upright");
    const auto model = taught_.LoadPairModel({pose});
    EXPECT_THAT(model, IsOk());
    frame_ = MakeFrame(scan, TaughtShapes::WorldSensor(), Plane(),
                       Box{{-0.3, -0.3, -0.05}, {0.3, 0.3, 0.4}}, {}, [] { return false; });
    return JudgePose(frame_, **model,
                     (TaughtShapes::WorldSensor().inverse() * world_object).cast<float>(), {});
  }
  float ScoreAt(const Scan& scan, const std::string& object, const Pose& world_object) {
    const SceneHypothesis judged = JudgeAt(scan, object, world_object);
    return SceneScore(frame_, judged, {});
  }

  TaughtShapes taught_;
  RecognitionParameters parameters_;
  Frame frame_;
};

TEST_F(SceneAnswersTest, APartThatAnUnknownNeighbourTouchesIsFound) {
  const Solid part = TaughtShapes::Part("bracket", -0.03, 0, 40);
  const auto found = Run(See({part, Unknown(0.07, 0.01, 0.08)}));
  ASSERT_THAT(found, IsOk());
  const Detection* bracket = Accepted(*found, "bracket");
  ASSERT_NE(bracket, nullptr);
  EXPECT_LT(LargestCornerError("bracket", bracket->refined_pose, part.world_solid), 0.01);
  EXPECT_FALSE(bracket->grasps.empty());
}

// A table that is too black to be measured.
Scan WithoutTable(Scan scan) {
  for (Eigen::Vector3f& p : scan.points) {
    if ((*scan.world_sensor * p.cast<double>()).z() > 0.003) continue;
    p.setConstant(std::numeric_limits<float>::quiet_NaN());
  }
  return scan;
}

TEST_F(SceneAnswersTest, APartOnATableThatIsNotMeasuredIsFound) {
  const Solid part = TaughtShapes::Part("bracket", -0.03, 0, 40);
  const auto found = Run(WithoutTable(See({part, Unknown(0.12, 0.01, 0.08)})));
  ASSERT_THAT(found, IsOk());
  const Detection* bracket = Accepted(*found, "bracket");
  ASSERT_NE(bracket, nullptr);
  EXPECT_LT(LargestCornerError("bracket", bracket->refined_pose, part.world_solid), 0.01);
}

// The clouds of one object cannot be read.
class WithoutTower : public ViewClouds {
 public:
  explicit WithoutTower(ViewClouds& all) : all_(all) {}
  absl::StatusOr<std::shared_ptr<const OrientedCloud>> Load(const TaughtView& view) override {
    return all_.Load(view);
  }
  absl::StatusOr<std::shared_ptr<const SurfaceModel>> LoadModel(
      const TaughtView& view, const TaughtStablePose& stable_pose) override {
    return all_.LoadModel(view, stable_pose);
  }
  absl::StatusOr<std::shared_ptr<const PairModel>> LoadPairModel(
      const StablePoses& stable_poses) override {
    if (stable_poses.front()->name.starts_with("objects/tower/")) {
      return absl::DataLossError("the cloud is damaged");
    }
    return all_.LoadPairModel(stable_poses);
  }

 private:
  ViewClouds& all_;
};

TEST_F(SceneAnswersTest, ADamagedObjectKeepsNoOtherFromBeingFound) {
  WithoutTower damaged(taught_);
  const Scan scan = See({TaughtShapes::Part("bracket", -0.03, 0, 40), Unknown(0.07, 0.01, 0.08)});
  const auto found =
      Recognize(scan, taught_.snapshot(), damaged, parameters_, [] { return false; });
  ASSERT_THAT(found, IsOk());
  EXPECT_NE(Accepted(*found, "bracket"), nullptr);
}

TEST_F(SceneAnswersTest, APartThatLeansOnAnUnknownOneIsNotNamedOtherwise) {
  const auto found = Run(See({Unknown(0, 0, 0.08)}));
  ASSERT_THAT(found, IsOk());
  for (const std::string object : {"bracket", "tower", "slab"}) {
    EXPECT_EQ(Accepted(*found, object), nullptr) << object;
  }
}

TEST_F(SceneAnswersTest, TheTruePoseScoresHigherThanOthers) {
  const Solid part = TaughtShapes::Part("tower", 0, 0, 30);
  const Scan scan = See({part});
  const float truth = ScoreAt(scan, "tower", part.world_solid);
  EXPECT_GT(truth, 1);
  for (const Eigen::Vector3d& shift :
       {Eigen::Vector3d(0.03, 0, 0), Eigen::Vector3d(0, 0, 0.02), Eigen::Vector3d(0, 0, -0.03)}) {
    Pose moved = part.world_solid;
    moved.pretranslate(shift);
    EXPECT_LT(ScoreAt(scan, "tower", moved), truth - 1) << shift.transpose();
  }
}

// Whatever can be laid on a heap in many ways is none of them.
TEST_F(SceneAnswersTest, AProposalNeedsALeadAndASeenArea) {
  constexpr float kLikely = 0.8F;
  constexpr float kAreaM2 = 0.01F;
  const double alone = ProposalScore(kLikely, /*lead=*/6, kAreaM2, {});
  EXPECT_GT(alone, 0.5);
  EXPECT_LT(ProposalScore(kLikely, /*lead=*/0.2F, kAreaM2, {}), 0.5);
  EXPECT_LT(ProposalScore(kLikely, /*lead=*/6, /*seen_area_m2=*/0.001F, {}), 0.5);
  EXPECT_LT(ProposalScore(-2, /*lead=*/6, kAreaM2, {}), 0.5);
  EXPECT_EQ(ProposalScore(kLikely, /*lead=*/60, kAreaM2, {}), alone)
      << "a longer lead adds nothing";
}

TEST_F(SceneAnswersTest, AModelLaidOnALargerSurfaceEndsNowhere) {
  Solid block;
  block.boxes = {{{-0.15, -0.12, 0}, {0.15, 0.12, 0.03}}};
  const SceneHypothesis judged = JudgeAt(See({block}), "slab", Pose::Identity());
  EXPECT_GT(judged.surface.seen, 0.3F);
  EXPECT_GT(judged.outline.smooth, 0.5F);
}

TEST_F(SceneAnswersTest, TheSameScanGivesTheSameAnswer) {
  const Scan scan = See({TaughtShapes::Part("bracket", -0.03, 0, 40), Unknown(0.07, 0.01, 0.08)});
  const auto a = Run(scan);
  const auto b = Run(scan);
  ASSERT_THAT(a, IsOk());
  ASSERT_THAT(b, IsOk());
  ASSERT_EQ(a->detections.size(), b->detections.size());
  for (std::size_t i = 0; i < a->detections.size(); ++i) {
    EXPECT_EQ(a->detections[i].refined_pose.matrix(), b->detections[i].refined_pose.matrix());
    EXPECT_EQ(a->detections[i].score, b->detections[i].score);
  }
}

// As between two revisions of a catalogue.
TEST_F(SceneAnswersTest, AnAnswerOfAStablePoseWithoutViewsStays) {
  TaughtShapes apart(/*shares_frame=*/false);
  CatalogueSnapshot snapshot = apart.snapshot();
  TaughtPoses without_views;
  for (const auto& [name, stable_pose] : *snapshot.stable_poses) {
    auto copy = std::make_shared<TaughtStablePose>(*stable_pose);
    copy->views.clear();
    without_views[name] = std::move(copy);
  }
  snapshot.stable_poses = std::make_shared<const TaughtPoses>(std::move(without_views));
  const auto found = Recognize(See({TaughtShapes::Part("tower", 0, 0, 30)}), snapshot, apart,
                               parameters_, [] { return false; });
  ASSERT_THAT(found, IsOk());
  EXPECT_NE(Accepted(*found, "tower"), nullptr);
}

TEST_F(SceneAnswersTest, AnAlignmentInTheImageEndsAtTheTruePose) {
  const Solid part = TaughtShapes::Part("tower", 0, 0, 30);
  JudgeAt(See({part}), "tower", part.world_solid);
  const auto model = taught_.LoadPairModel(
      {taught_.snapshot().stable_poses->at("objects/tower/stablePoses/upright")});
  ASSERT_THAT(model, IsOk());
  Eigen::Isometry3f start =
      (TaughtShapes::WorldSensor().inverse() * part.world_solid).cast<float>();
  const Eigen::Isometry3f truth = start;
  start.pretranslate(Eigen::Vector3f(0.006F, 0.004F, -0.006F));
  ImageRefinementParameters steps;
  steps.iterations = 20;
  const Eigen::Isometry3f refined = RefineInImage(frame_, **model, start, steps);
  EXPECT_LT((refined.translation() - truth.translation()).norm(), 0.004F);
}

TEST_F(SceneAnswersTest, StagesAreReported) {
  const auto found =
      Run(See({TaughtShapes::Part("bracket", -0.03, 0, 40), Unknown(0.07, 0.01, 0.08)}));
  ASSERT_THAT(found, IsOk());
  std::vector<std::string> stages;
  for (const StageReport& report : found->stages) stages.push_back(report.stage);
  EXPECT_THAT(stages,
              ::testing::IsSupersetOf({"frame", "verify", "propose", "confirm", "explain"}));
}

// The smallest errors of the bracket's corners, m.
class NearestPoses {
 public:
  PoseObserver Observer(const Pose& world_bracket) {
    return [=, this](PoseStep step, PoseSource source, std::span<const ObservedPose> poses) {
      const std::lock_guard lock(mutex_);
      for (const ObservedPose& pose : poses) {
        if (pose.stable_pose != "objects/bracket/stablePoses/upright") continue;
        double& error = errors_.try_emplace({source, step}, 1).first->second;
        error = std::min(error, LargestCornerError("bracket", pose.world_object, world_bracket));
      }
    };
  }
  double At(PoseSource source, PoseStep step) const {
    const auto found = errors_.find({source, step});
    return found == errors_.end() ? 1 : found->second;
  }

 private:
  std::mutex mutex_;
  std::map<std::pair<PoseSource, PoseStep>, double> errors_;
};

TEST_F(SceneAnswersTest, AnObserverSeesThePosesOfEveryStepAndChangesNoAnswer) {
  const Solid part = TaughtShapes::Part("bracket", -0.03, 0, 40);
  const Scan scan = See({part});
  const auto unobserved = Run(scan);
  NearestPoses nearest;
  parameters_.matching.observer = nearest.Observer(part.world_solid);
  const auto observed = Run(scan);
  ASSERT_THAT(unobserved, IsOk());
  ASSERT_THAT(observed, IsOk());
  ASSERT_EQ(observed->detections.size(), 1U);
  EXPECT_EQ(observed->detections[0].refined_pose.matrix(),
            unobserved->detections[0].refined_pose.matrix());
  // Without segments everything is searched for in the image.
  parameters_.segmentation.min_cluster_point_count = 1'000'000;
  ASSERT_THAT(Run(scan), IsOk());
  for (const PoseSource source : {PoseSource::kSegment, PoseSource::kImage}) {
    EXPECT_LT(nearest.At(source, PoseStep::kProposed), 0.03);
    EXPECT_LT(nearest.At(source, PoseStep::kKept), 0.03);
    EXPECT_LT(nearest.At(source, PoseStep::kRefined), 0.01);
  }
}

TEST_F(SceneAnswersTest, ACancelledSearchEnds) {
  const Scan scan = See({Unknown(0, 0, 0.08)});
  int calls = 0;
  const auto answer =
      Recognize(scan, taught_.snapshot(), taught_, parameters_, [&calls] { return ++calls > 40; });
  EXPECT_EQ(answer.status().code(), absl::StatusCode::kCancelled);
}

}  // namespace
}  // namespace graspdb::recognition
