// Hand-made poses of a bracket on the table, and how far they count.
#include <gmock/gmock.h>

#include "lab/experiment/gallery.h"
#include "lab/experiment/real_frames.h"
#include "rendering/sample_parts.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::lab {
namespace {

using ::graspdb::testing::IsOk;
using recognition::ObservedPose;
using recognition::Pose;
using recognition::PoseSource;
using recognition::PoseStep;

class PoseStagesTest : public ::testing::Test {
 protected:
  PoseStagesTest() {
    for (const char* name : {"l-bracket", "flange"}) {
      auto parts = rendering::SampleParts({name});
      EXPECT_THAT(parts, IsOk());
      set_.Add(parts->front(), Pose::Identity());
    }
    diameter_m_ = set_.shapes[0]->diameter_m;
  }

  // The bracket, this share of its diameter above its true pose.
  Pose Above(double share) const {
    return true_pose_ * Pose(Eigen::Translation3d(0, 0, share * diameter_m_));
  }
  Pose OnItsHead() const {
    return true_pose_ * Pose(Eigen::AngleAxisd(3, Eigen::Vector3d::UnitX()));
  }

  void Report(PoseRecord* record, PoseStep step, const std::vector<Pose>& poses,
              PoseSource source = PoseSource::kSegment) const {
    const std::string name = StablePoseName(set_.parts[0]);
    std::vector<ObservedPose> observed;
    observed.reserve(poses.size());
    for (const Pose& pose : poses) observed.push_back({name, pose});
    record->Observer()(step, source, observed);
  }

  PoseStage StageOf(const PoseRecord& record, PoseSource source = PoseSource::kSegment) const {
    return record.StageOf("l-bracket", true_pose_, source);
  }

  // Of one step alone.
  PoseStage StageAfter(PoseStep step, const std::vector<Pose>& poses) const {
    PoseRecord record(set_, {"l-bracket"});
    Report(&record, step, poses);
    return StageOf(record);
  }

  const Pose true_pose_ = Pose(Eigen::Translation3d(0.1, 0.05, 0));  // T_world_object
  PartSet set_;
  double diameter_m_ = 0;
};

TEST_F(PoseStagesTest, APoseThatIsToBeRefinedNeedsToBeNearOnly) {
  const Pose far = Above(0.45);
  const Pose near = Above(0.25);
  const auto share_of = [&](const Pose& pose) { return ShareOff(set_, 0, pose, true_pose_); };
  ASSERT_GT(share_of(far), kNearShare);
  ASSERT_GT(share_of(near), kFoundShare);
  ASSERT_LT(share_of(near), kNearShare);
  EXPECT_EQ(StageAfter(PoseStep::kProposed, {far, near}), PoseStage::kProposed);
  EXPECT_EQ(StageAfter(PoseStep::kKept, {near}), PoseStage::kKept);
  EXPECT_EQ(StageAfter(PoseStep::kProposed, {far}), PoseStage::kNone);
  EXPECT_EQ(StageAfter(PoseStep::kRefined, {near}), PoseStage::kNone);
  EXPECT_EQ(StageAfter(PoseStep::kRefined, {Above(0.05)}), PoseStage::kBest);
}

TEST_F(PoseStagesTest, ABetterWrongPoseAtThePlaceIsTheBest) {
  const Pose right = Above(0);
  const Pose elsewhere = true_pose_ * Pose(Eigen::Translation3d(diameter_m_, 0, 0));
  EXPECT_EQ(StageAfter(PoseStep::kRefined, {OnItsHead(), right}), PoseStage::kRefined);
  EXPECT_EQ(StageAfter(PoseStep::kRefined, {right, OnItsHead()}), PoseStage::kBest);
  EXPECT_EQ(StageAfter(PoseStep::kRefined, {elsewhere, right}), PoseStage::kBest);
}

TEST_F(PoseStagesTest, TheFurthestStageCountsInAnyOrder) {
  PoseRecord record(set_, {"l-bracket"});
  EXPECT_EQ(StageOf(record), PoseStage::kNone);
  Report(&record, PoseStep::kRefined, {Above(0)});
  Report(&record, PoseStep::kRefined, {OnItsHead(), Above(0)});
  Report(&record, PoseStep::kProposed, {Above(0)});
  EXPECT_EQ(StageOf(record), PoseStage::kBest);
  EXPECT_EQ(StageOf(record, PoseSource::kImage), PoseStage::kNone);
  Report(&record, PoseStep::kKept, {Above(0)}, PoseSource::kImage);
  EXPECT_EQ(StageOf(record, PoseSource::kImage), PoseStage::kKept);
}

TEST_F(PoseStagesTest, StablePosesOfOneMeshAreOneObjectAndOthersAreNot) {
  const Pose object_mesh(Eigen::AngleAxisd(1, Eigen::Vector3d::UnitY()));
  set_.Add(set_.parts[0], object_mesh);
  set_.parts.back().stable_pose_id = "tilted";
  PoseRecord record(set_, {"l-bracket"});
  const std::string tilted = StablePoseName(set_.parts.back());
  const std::string flange = StablePoseName(set_.parts[1]);
  // T_world_mesh is the true pose.
  const ObservedPose right = {tilted, true_pose_ * object_mesh.inverse()};
  const ObservedPose other = {flange, true_pose_};
  record.Observer()(PoseStep::kRefined, PoseSource::kImage, {&other, 1});
  EXPECT_EQ(StageOf(record, PoseSource::kImage), PoseStage::kNone);
  record.Observer()(PoseStep::kRefined, PoseSource::kImage, {&right, 1});
  EXPECT_EQ(StageOf(record, PoseSource::kImage), PoseStage::kBest);
}

}  // namespace
}  // namespace graspdb::lab
