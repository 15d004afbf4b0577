#include "client/cell/agent/jobs/job_answer.h"

#include <gmock/gmock.h>

#include "files/messages/pose_message.h"

namespace graspdb::client {
namespace {

using recognition::Pose;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

Pose AtXYZ(double x, double y, double z) { return Pose(Eigen::Translation3d(x, y, z)); }

// A tool that points down.
Pose ToolAt(double x, double y, double z) {
  Pose out = AtXYZ(x, y, z);
  out.rotate(Eigen::AngleAxisd(3.141592653589793, Eigen::Vector3d::UnitX()));
  return out;
}

v1::Detection Object(const std::string& object, double x) {
  v1::Detection out;
  out.set_status(v1::OK);
  out.set_object("objects/" + object);
  out.set_stable_pose("objects/" + object + "/stablePoses/flat");
  out.set_score(0.9);
  *out.mutable_refined_pose() = files::ToMessage(AtXYZ(x, 0, 0));
  return out;
}

void AddGrasp(const std::string& id, const Pose& world_tcp, v1::Detection* object) {
  v1::GraspProposal* proposal = object->add_grasps();
  *proposal->mutable_tcp_pose() = files::ToMessage(world_tcp);
  v1::Grasp* grasp = proposal->mutable_grasp();
  grasp->set_grasp_id(id);
  grasp->set_approach_distance_m(0.1);
  grasp->set_retreat_distance_m(0.2);
  grasp->set_gripper_opening_m(0.05);
}

class PosesForTest : public ::testing::Test {
 protected:
  PosesForTest() {
    // A mug with two grasps and a nut with one; the robot stands a metre behind the world's origin.
    v1::Detection mug = Object("mug", 0.1);
    AddGrasp("rim", ToolAt(0.1, 0, 0.1), &mug);
    AddGrasp("side", ToolAt(0.15, 0, 0.05), &mug);
    v1::Detection nut = Object("nut", 0.3);
    AddGrasp("top", ToolAt(0.3, 0, 0.02), &nut);
    *answer_.add_detections() = mug;
    *answer_.add_detections() = nut;
    frames_.world_base = AtXYZ(-1, 0, 0);
  }

  std::vector<JobPose> Poses() const {
    return PosesFor(job_, answer_, frames_, reach_,
                    [](const std::string& object, const std::string& label) {
                      return object == "objects/nut" && label == "steel";
                    });
  }

  std::string Reason() const {
    return NoPoseReason(job_, answer_, [](const std::string& object, const std::string& label) {
      return object == "objects/nut" && label == "steel";
    });
  }

  std::vector<std::string> Ids() const {
    std::vector<std::string> out;
    for (const JobPose& pose : Poses()) out.push_back(pose.object + " " + pose.grasp.grasp_id());
    return out;
  }

  JobConfig job_;
  v1::RecognizeResponse answer_;
  CellFrames frames_;
  Reach reach_;
};

TEST_F(PosesForTest, GraspsAreInResponseOrderWithTheirObjectRelated) {
  EXPECT_THAT(Ids(), ElementsAre("objects/mug rim", "objects/mug side", "objects/nut top"));
  const JobPose first = Poses()[0];
  EXPECT_TRUE(first.base_primary.isApprox(AtXYZ(1, 0, 0) * ToolAt(0.1, 0, 0.1)));
  ASSERT_THAT(first.base_related, SizeIs(1));
  EXPECT_TRUE(first.base_related[0].isApprox(AtXYZ(1.1, 0, 0)));
  EXPECT_THAT(first.related_grasps, IsEmpty());
  EXPECT_EQ(first.grasp.gripper_opening_m(), 0.05);
  EXPECT_EQ(first.grasp.approach_distance_m(), 0.1);
  EXPECT_EQ(first.grasp.retreat_distance_m(), 0.2);
  EXPECT_EQ(first.stable_pose, "objects/mug/stablePoses/flat");
}

TEST_F(PosesForTest, APrimaryObjectHasItsGraspsRelated) {
  job_.primary = JobPrimary::kObject;
  answer_.mutable_detections(0)->mutable_grasps(1)->mutable_grasp()->set_gripper_opening_m(0.07);
  EXPECT_THAT(Ids(), ElementsAre("objects/mug rim", "objects/nut top"));
  const JobPose mug = Poses()[0];
  EXPECT_TRUE(mug.base_primary.isApprox(AtXYZ(1.1, 0, 0)));
  ASSERT_THAT(mug.base_related, SizeIs(2));
  EXPECT_TRUE(mug.base_related[1].isApprox(AtXYZ(1, 0, 0) * ToolAt(0.15, 0, 0.05)));
  ASSERT_THAT(mug.related_grasps, SizeIs(2));
  EXPECT_EQ(mug.grasp.gripper_opening_m(), 0.05);
  EXPECT_EQ(mug.related_grasps[1].grasp_id(), "side");
  EXPECT_EQ(mug.related_grasps[1].gripper_opening_m(), 0.07);
}

TEST_F(PosesForTest, FiltersByObjectAndLabel) {
  job_.object = "objects/mug";
  EXPECT_THAT(Ids(), ElementsAre("objects/mug rim", "objects/mug side"));
  job_.object.clear();
  job_.label = "steel";
  EXPECT_THAT(Ids(), ElementsAre("objects/nut top"));
  job_.label = "brass";
  EXPECT_THAT(Ids(), IsEmpty());
}

TEST_F(PosesForTest, SkipsObjectsBelowTheMinimumScore) {
  answer_.mutable_detections(0)->set_score(0.7);
  job_.min_score = 0.8;
  EXPECT_THAT(Ids(), ElementsAre("objects/nut top"));
}

TEST_F(PosesForTest, SkipsObjectsThatAreNotOk) {
  for (const auto status :
       {v1::UNKNOWN_OBJECT, v1::AMBIGUOUS, v1::OUT_OF_WORKSPACE, v1::NO_GRASP}) {
    answer_.mutable_detections(0)->set_status(status);
    EXPECT_THAT(Ids(), ElementsAre("objects/nut top"));
  }
}

TEST_F(PosesForTest, AnObjectWithoutGraspsHasAPose) {
  answer_.mutable_detections(1)->set_status(v1::NO_GRASP);
  answer_.mutable_detections(1)->clear_grasps();
  job_.primary = JobPrimary::kObject;
  EXPECT_THAT(Ids(), ElementsAre("objects/mug rim", "objects/nut "));
}

TEST_F(PosesForTest, TheReasonForNoPoseNamesEachObjectsFault) {
  answer_.mutable_detections(0)->set_status(v1::OUT_OF_WORKSPACE);
  answer_.mutable_detections(1)->set_score(0.7);
  job_.min_score = 0.8;
  EXPECT_EQ(Reason(),
            "no object in the frame fits: objects/mug OUT_OF_WORKSPACE; objects/nut scores 0.70, "
            "less than min-score");
}

TEST_F(PosesForTest, TheReasonForNoPoseNamesObjectLabelAndReach) {
  job_.object = "objects/nut";
  EXPECT_EQ(Reason(),
            "no object in the frame fits: no grasp of objects/nut is within reach; objects/mug is "
            "another object");
  job_.object.clear();
  job_.label = "brass";
  EXPECT_EQ(Reason(),
            "no object in the frame fits: objects/mug lacks the label brass; objects/nut lacks the "
            "label brass");
}

TEST_F(PosesForTest, TheReasonForNoPoseIsBounded) {
  for (const char* id : {"bolt", "cap", "disc"}) *answer_.add_detections() = Object(id, 0);
  job_.object = "objects/flange";
  EXPECT_EQ(Reason(),
            "no object in the frame fits: objects/bolt is another object; objects/cap is another "
            "object; objects/disc is another object; and 2 more");
}

TEST_F(PosesForTest, TheReasonForNoPoseIsTheStatusOfAFrameWithoutObjects) {
  answer_.clear_detections();
  answer_.set_status(v1::NO_CLUSTER);
  EXPECT_EQ(Reason(), "the frame shows no object: NO_CLUSTER");
  answer_.add_detections()->set_status(v1::UNKNOWN_OBJECT);
  answer_.add_detections()->set_status(v1::UNKNOWN_OBJECT);
  EXPECT_EQ(Reason(), "no object in the frame fits: UNKNOWN_OBJECT");
}

TEST_F(PosesForTest, IsolatedObjectsComeFirst) {
  answer_.mutable_detections(0)->set_touching(true);
  EXPECT_THAT(Ids(), ElementsAre("objects/nut top", "objects/mug rim", "objects/mug side"));
}

TEST_F(PosesForTest, SkipsUnreachableGraspsAndObjectsWithoutReachableOnes) {
  reach_.max_m = 1.2;  // from the base: of the mug the rim is 1.1 m away, the nut 1.3
  EXPECT_THAT(Ids(), ElementsAre("objects/mug rim", "objects/mug side"));
  job_.primary = JobPrimary::kObject;
  EXPECT_THAT(Ids(), ElementsAre("objects/mug rim"));
}

TEST_F(PosesForTest, ApproachAndRetreatMustBeInTheWorkspace) {
  reach_.workspace = recognition::Box{{-1, -1, 0}, {1, 1, 0.29}};  // the rim's retreat ends at 0.3
  EXPECT_THAT(Ids(), ElementsAre("objects/mug side", "objects/nut top"));
  reach_.workspace = recognition::Box{{-1, -1, 0}, {1, 1, 0.14}};
  EXPECT_THAT(Ids(), IsEmpty());
}

TEST_F(PosesForTest, ReturnsAtMostTheJobsNumberOfPoses) {
  job_.max_poses = 1;
  EXPECT_THAT(Ids(), ElementsAre("objects/mug rim"));
}

}  // namespace
}  // namespace graspdb::client
