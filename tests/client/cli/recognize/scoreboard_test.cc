// Responses compared with the ground truth.
#include "client/cli/recognize/scoreboard.h"

#include <gmock/gmock.h>

#include <numbers>

namespace graspdb::client {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class ScoreboardTest : public ::testing::Test {
 protected:
  ScoreboardTest() {
    v1::CapturedObject* object = set_.add_objects();
    object->set_object_id("nut");
    object->add_stable_poses()->set_stable_pose_id("flat");
    object->mutable_stable_poses(0)->set_symmetry_order(6);
    task_.path = "clouds/scene_1.pcd";
    task_.in_set = true;
    task_.set = &set_;
    task_.capture.set_object_id("nut");
    task_.capture.set_stable_pose_id("flat");
    *task_.capture.mutable_object_pose() = PoseAt(0.1, 0);
  }

  static v1::Pose PoseAt(double x, double turn_rad) {
    v1::Pose pose;
    pose.mutable_position()->set_x(x);
    pose.mutable_orientation()->set_z(std::sin(turn_rad / 2));
    pose.mutable_orientation()->set_w(std::cos(turn_rad / 2));
    return pose;
  }

  static v1::Detection* Add(v1::RecognizeResponse* response, const std::string& object, double x,
                            double turn_rad) {
    v1::Detection* detection = response->add_detections();
    detection->set_object(object);
    detection->set_status(object.empty() ? v1::UNKNOWN_OBJECT : v1::OK);
    detection->mutable_centroid()->set_x(x);
    *detection->mutable_refined_pose() = PoseAt(x, turn_rad);
    return detection;
  }

  v1::CaptureSet set_;
  ScanTask task_;
  v1::RecognizeResponse response_;
};

TEST_F(ScoreboardTest, TheDetectionNearestToTheTruthIsJudged) {
  EXPECT_EQ(MainDetection(task_, response_), nullptr);
  Add(&response_, "objects/bolt", -0.2, 0);
  Add(&response_, "objects/nut", 0.11, 0);
  Add(&response_, "objects/pipe", 0.3, 0);
  EXPECT_EQ(MainDetection(task_, response_)->object(), "objects/nut");
  task_.capture.clear_object_pose();
  EXPECT_EQ(MainDetection(task_, response_)->object(), "objects/bolt");
}

TEST_F(ScoreboardTest, TheErrorIsTakenModuloTheSymmetry) {
  Add(&response_, "objects/nut", 0.103, std::numbers::pi / 3 + 0.01);
  const std::optional<Verdict> verdict = Judge(task_, response_);
  ASSERT_TRUE(verdict);
  EXPECT_TRUE(verdict->object_right);
  EXPECT_NEAR(*verdict->translation_error_m, 0.003, 1e-9);
  EXPECT_NEAR(*verdict->rotation_error_deg, 0.01 * 180 / std::numbers::pi, 1e-6);
  EXPECT_FALSE(verdict->add_s_m) << "there is no model to compute it with";
}

TEST_F(ScoreboardTest, AnotherObjectIsWrongAndHasNoPoseError) {
  Add(&response_, "objects/nuts", 0.1, 0);
  const std::optional<Verdict> verdict = Judge(task_, response_);
  ASSERT_TRUE(verdict);
  EXPECT_FALSE(verdict->object_right);
  EXPECT_FALSE(verdict->translation_error_m);
}

TEST_F(ScoreboardTest, NoDetectionIsWrongUnlessTheSceneHasNoKnownObject) {
  EXPECT_FALSE(Judge(task_, response_)->object_right);
  task_.capture.clear_object_id();
  EXPECT_TRUE(Judge(task_, response_)->object_right);
  Add(&response_, "", 0.1, 0);
  EXPECT_TRUE(Judge(task_, response_)->object_right);
  Add(&response_, "objects/nut", 0.1, 0);
  response_.mutable_detections()->SwapElements(0, 1);
  EXPECT_FALSE(Judge(task_, response_)->object_right);
}

TEST_F(ScoreboardTest, AFileWithoutTruthIsNotJudged) {
  task_.in_set = false;
  Add(&response_, "objects/nut", 0.1, 0);
  EXPECT_FALSE(Judge(task_, response_));
}

TEST_F(ScoreboardTest, AFileWithoutTruthHasThePosesOfItsObjects) {
  Add(&response_, "objects/nut", 0.1, 0);
  Add(&response_, "", 0.2, 0);
  Add(&response_, "objects/bolt", 0.3, 0);
  const auto printed = [&] {
    ::testing::internal::CaptureStdout();
    Scoreboard().Add(task_, response_);
    return ::testing::internal::GetCapturedStdout();
  };
  EXPECT_THAT(printed(), Not(HasSubstr(" at "))) << "errors are printed where the truth is known";
  task_.in_set = false;
  const std::string out = printed();
  EXPECT_THAT(out, HasSubstr("  nut at 0.1000,0.0000,0.0000 m, orientation 0.0000,0.0000,0.0000,"));
  EXPECT_THAT(out, HasSubstr("  bolt at 0.3000,"));
  EXPECT_THAT(out, Not(HasSubstr("0.2000")));
}

TEST_F(ScoreboardTest, TheSummaryHasTheShareOfCorrectResults) {
  ::testing::internal::CaptureStdout();
  Scoreboard board;
  Scoreboard::PrintHeader();
  v1::RecognizeResponse right;
  Add(&right, "objects/nut", 0.1, 0);
  v1::RecognizeResponse wrong;
  Add(&wrong, "objects/bolt", 0.1, 0);
  for (const v1::RecognizeResponse* response : {&right, &wrong, &right, &right}) {
    board.Add(task_, *response);
  }
  board.PrintSummary();
  const std::string out = ::testing::internal::GetCapturedStdout();
  EXPECT_THAT(out, HasSubstr("scene_1"));
  EXPECT_THAT(out, HasSubstr("bolt (wrong)"));
  EXPECT_THAT(out, HasSubstr("4 scans"));
  EXPECT_THAT(out, HasSubstr("object right 75.0 % (3 of 4)"));
}

}  // namespace
}  // namespace graspdb::client
