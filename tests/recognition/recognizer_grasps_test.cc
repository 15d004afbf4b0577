// The grasps that come with a detection.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "recognition/recognizer.h"
#include "tests/recognition/scenes/taught_shapes.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::recognition {
namespace {

using ::graspdb::testing::IsOk;
using ::graspdb::testing::Solid;
using ::graspdb::testing::TaughtShapes;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class RecognizerGraspsTest : public ::testing::Test {
 protected:
  Recognition Must(const Solid& part) { return Must(part, taught_.snapshot()); }

  Recognition Must(const Solid& part, const CatalogueSnapshot& catalogue) {
    auto found =
        Recognize(TaughtShapes::See({part}), catalogue, taught_, parameters_, [] { return false; });
    EXPECT_THAT(found, IsOk());
    if (!found.ok() || found->detections.size() != 1) {
      ADD_FAILURE() << "expected exactly one detection";
      return {RecognitionOutcome::kNoCluster, 0, Pose::Identity(), WorldFrame::kGiven, {{}}, {}};
    }
    return *std::move(found);
  }

  const Solid bracket_ = TaughtShapes::Part("bracket", 0.04, -0.05, 55);
  TaughtShapes taught_;
  RecognitionParameters parameters_;
};

TEST_F(RecognizerGraspsTest, GraspsMoveWithTheRefinedPose) {
  const Recognition found = Must(bracket_);
  const Detection& detection = found.detections[0];
  EXPECT_EQ(detection.outcome, RecognitionOutcome::kOk);
  ASSERT_THAT(detection.grasps, SizeIs(2));
  for (const GraspProposal& proposal : detection.grasps) {
    const Pose expected = detection.refined_pose * proposal.grasp.object_tcp;
    EXPECT_EQ(proposal.world_tcp.matrix(), expected.matrix()) << proposal.grasp.id;
    const Pose truth = bracket_.world_solid * proposal.grasp.object_tcp;
    EXPECT_LT((proposal.world_tcp.translation() - truth.translation()).norm(), 0.004);
  }
}

TEST_F(RecognizerGraspsTest, HighestPriorityComesFirst) {
  const Recognition found = Must(bracket_);
  const auto& grasps = found.detections[0].grasps;
  ASSERT_THAT(grasps, SizeIs(2));
  EXPECT_EQ(grasps[0].grasp.id, "top");
  EXPECT_EQ(grasps[1].grasp.id, "side");
}

TEST_F(RecognizerGraspsTest, GraspsOutsideTheWorkspaceAreLeftOut) {
  parameters_.workspace = Box{{-1, -1, 0.07}, {1, 1, 1}};  // "side" is 5 cm up
  const Recognition found = Must(bracket_);
  ASSERT_THAT(found.detections[0].grasps, SizeIs(1));
  EXPECT_EQ(found.detections[0].grasps[0].grasp.id, "top");
  EXPECT_EQ(found.outcome, RecognitionOutcome::kOk);
}

TEST_F(RecognizerGraspsTest, NoGraspInTheWorkspaceIsOutOfWorkspace) {
  parameters_.workspace = Box{{-1, -1, 0.5}, {1, 1, 1}};
  const Recognition found = Must(bracket_);
  EXPECT_THAT(found.detections[0].grasps, IsEmpty());
  EXPECT_EQ(found.detections[0].outcome, RecognitionOutcome::kOutOfWorkspace);
  EXPECT_EQ(found.outcome, RecognitionOutcome::kOutOfWorkspace);
}

TEST_F(RecognizerGraspsTest, StablePoseWithoutGraspsIsNoGraspButStillHasItsPose) {
  const Solid slab = TaughtShapes::Part("slab", 0.04, -0.05, 55);
  const Recognition found = Must(slab);
  EXPECT_EQ(found.outcome, RecognitionOutcome::kNoGrasp);
  ASSERT_TRUE(found.detections[0].view);
  EXPECT_LT(graspdb::testing::LargestCornerError("slab", found.detections[0].refined_pose,
                                                 slab.world_solid),
            0.004);
}

TEST_F(RecognizerGraspsTest, StablePoseThatIsNotInTheCatalogueIsNoGrasp) {
  parameters_.matching.verified_view_count = 1;
  CatalogueSnapshot catalogue = taught_.snapshot();
  catalogue.stable_poses =
      std::make_shared<std::unordered_map<std::string, std::shared_ptr<const TaughtStablePose>>>();
  EXPECT_EQ(Must(TaughtShapes::Part("bracket", 0, 0, 12), catalogue).outcome,
            RecognitionOutcome::kNoGrasp);
}

}  // namespace
}  // namespace graspdb::recognition
