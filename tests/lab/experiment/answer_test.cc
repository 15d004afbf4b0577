#include "lab/experiment/answer.h"

#include <gtest/gtest.h>

#include "lab/experiment/gallery.h"
#include "tests/lab/experiment/hand_made_case.h"

namespace graspdb::lab {
namespace {

using recognition::Pose;
using recognition::RecognitionOutcome;

// The first part is at the origin and is queried.
class AnswerTest : public ::testing::Test {
 protected:
  AnswerTest() {
    trial_.truth = {{.part = 0, .world_object = Pose::Identity()}};
    trial_.seen = {Eigen::Vector3d::Zero()};
    recognition_.outcome = RecognitionOutcome::kOk;
  }

  std::shared_ptr<const recognition::TaughtView> ViewOf(std::size_t part) const {
    auto view = std::make_shared<recognition::TaughtView>();
    view->object = ObjectName(set_.parts[part]);
    view->stable_pose = StablePoseName(set_.parts[part]);
    view->shares_frame = true;
    return view;
  }

  recognition::Detection& Detect(std::size_t part, const Pose& pose, RecognitionOutcome outcome) {
    recognition::Detection detection;
    detection.outcome = outcome;
    detection.view = ViewOf(part);
    detection.refined_pose = pose;
    recognition_.detections.push_back(std::move(detection));
    return recognition_.detections.back();
  }

  Answer Judged() const { return JudgeAnswer(recognition_, trial_, 0, set_); }

  static Pose Aside() { return Pose(Eigen::Translation3d(0.1, 0, 0)); }

  PartSet set_ = HandMadeParts();
  Trial trial_;
  recognition::Recognition recognition_;
};

TEST_F(AnswerTest, JudgesTheFirstReading) {
  Detect(0, Pose::Identity(), RecognitionOutcome::kOk);
  const Answer answer = Judged();
  EXPECT_TRUE(answer.strictly_right);
  EXPECT_FALSE(answer.listed);
}

TEST_F(AnswerTest, IsWrongByItsObjectWhereThereIsNoPoseToJudge) {
  Answer answer = RightAnswer(set_, 0, 0);
  EXPECT_FALSE(IsWrong(answer));
  answer.strictly_right = false;
  EXPECT_TRUE(IsWrong(answer));
  answer.posed = false;
  EXPECT_FALSE(IsWrong(answer));
  answer.object_right = false;
  EXPECT_TRUE(IsWrong(answer));
}

// A view that was taught without an object pose has its own frame.
TEST_F(AnswerTest, JudgesOnlyTheObjectInAnUnknownFrame) {
  recognition::TaughtView view = *ViewOf(0);
  view.shares_frame = false;
  Detect(0, Aside(), RecognitionOutcome::kOk).view =
      std::make_shared<const recognition::TaughtView>(view);
  const Answer answer = Judged();
  EXPECT_TRUE(answer.object_right);
  EXPECT_FALSE(answer.posed);
}

TEST_F(AnswerTest, CountsAndMarksAListedPoseOfAnAmbiguousAnswer) {
  Detect(0, Aside(), RecognitionOutcome::kAmbiguous).equivalent_poses = {Aside(), Pose::Identity()};
  const Answer answer = Judged();
  EXPECT_TRUE(answer.strictly_right);
  EXPECT_TRUE(answer.listed);
  EXPECT_TRUE(answer.found.isApprox(Aside())) << "the first reading is reported";
}

TEST_F(AnswerTest, CountsAndMarksAListedObjectOfAnAmbiguousAnswer) {
  Detect(1, Pose::Identity(), RecognitionOutcome::kAmbiguous).alternatives = {
      {ViewOf(0), Pose::Identity(), 0.5}};
  const Answer answer = Judged();
  EXPECT_TRUE(answer.object_right);
  EXPECT_TRUE(answer.listed);
  EXPECT_EQ(answer.stable_pose, StablePoseName(set_.parts[1]));
}

TEST_F(AnswerTest, IgnoresOtherReadingsOfAnUnambiguousAnswer) {
  recognition::Detection& sure = Detect(1, Pose::Identity(), RecognitionOutcome::kOk);
  sure.alternatives = {{ViewOf(0), Pose::Identity(), 0.5}};
  sure.equivalent_poses = {Pose::Identity()};
  const Answer answer = Judged();
  EXPECT_FALSE(answer.object_right);
  EXPECT_FALSE(answer.listed);
}

TEST_F(AnswerTest, RejectsTheRightObjectAtAWrongPosition) {
  Detect(0, Aside(), RecognitionOutcome::kAmbiguous);
  const Answer answer = Judged();
  EXPECT_TRUE(answer.object_right);
  EXPECT_FALSE(answer.pose_right);
}

TEST_F(AnswerTest, AcceptsNoAnswerForAnUnknownObject) {
  trial_.truth[0].part = set_.taught_count;
  recognition_.outcome = RecognitionOutcome::kNoCluster;
  EXPECT_TRUE(Judged().object_right);
  Detect(0, Pose::Identity(), RecognitionOutcome::kAmbiguous);
  EXPECT_FALSE(Judged().object_right);
}

}  // namespace
}  // namespace graspdb::lab
