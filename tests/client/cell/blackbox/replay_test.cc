#include "client/cell/blackbox/replay.h"

#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>

#include <cmath>

namespace graspdb::client {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

v1::RecognizeResponse Answer() {
  v1::RecognizeResponse out;
  out.set_status(v1::OK);
  out.set_catalog_revision(41);
  v1::Detection& detection = *out.add_detections();
  detection.set_object("objects/flange");
  detection.set_stable_pose("objects/flange/stablePoses/flat");
  detection.set_status(v1::OK);
  detection.set_score(0.84);
  detection.mutable_refined_pose()->mutable_position()->set_x(0.1);
  detection.mutable_refined_pose()->mutable_orientation()->set_w(1);
  v1::Grasp& grasp = *detection.add_grasps()->mutable_grasp();
  grasp.set_grasp_id("top");
  grasp.mutable_tcp_pose();
  out.add_stages()->set_stage("plane");
  return out;
}

v1::Bundle BundleOf(const v1::RecognizeResponse& answer) {
  v1::Bundle out;
  out.mutable_request()->set_cell("cells/c");
  *out.mutable_response() = answer;
  return out;
}

TEST(ReplayTest, RequestsTheSameWithoutTimings) {
  v1::RecognizeRequest expected = BundleOf(Answer()).request();
  expected.set_omit_timings(true);
  EXPECT_EQ(ReplayRequest(BundleOf(Answer())).SerializeAsString(), expected.SerializeAsString());
}

TEST(ReplayTest, TimingsRevisionsAndIdsOfCataloguesAreIgnored) {
  v1::RecognizeResponse then = Answer();
  then.set_catalog_id("original");
  then.mutable_timings()->set_total_ms(12);
  then.mutable_stages(0)->set_duration_ms(3);
  v1::RecognizeResponse now = Answer();
  now.set_catalog_revision(44);
  const ReplayResult result = CompareReplay(BundleOf(then), now);
  EXPECT_TRUE(result.is_same);
  EXPECT_EQ(result.revision_then, 41);
  EXPECT_EQ(result.revision_now, 44);
  EXPECT_THAT(result.differences, IsEmpty());
}

TEST(ReplayTest, DifferencesAreReported) {
  v1::RecognizeResponse now = Answer();
  v1::Detection& detection = *now.mutable_detections(0);
  detection.set_score(0.9);
  detection.mutable_refined_pose()->mutable_position()->set_x(0.1005);
  detection.mutable_refined_pose()->mutable_orientation()->set_w(0.5);
  detection.mutable_refined_pose()->mutable_orientation()->set_z(0.8660254037844386);
  detection.mutable_grasps(0)->mutable_grasp()->set_grasp_id("side");
  const ReplayResult result = CompareReplay(BundleOf(Answer()), now);
  EXPECT_FALSE(result.is_same);
  EXPECT_THAT(
      result.differences,
      ElementsAre(AllOf(HasSubstr("objects/flange"), HasSubstr("0.5 mm and 120 degrees")),
                  HasSubstr("score 0.8400, now 0.9000"), HasSubstr("grasps top, now side")));
}

TEST(ReplayTest, DifferentObjectsAndCountsAreReported) {
  v1::RecognizeResponse now = Answer();
  now.mutable_detections(0)->set_object("objects/cap");
  now.add_detections();
  EXPECT_THAT(CompareReplay(BundleOf(Answer()), now).differences,
              ElementsAre("1 objects, now 2", "object 1: objects/flange, now objects/cap"));
}

// As of a server of before GraspProposal.grasp: `grasps` is the text of its proposals.
v1::RecognizeResponse EarlierAnswer(const std::string& grasps) {
  v1::Detection earlier;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(grasps, &earlier));
  v1::RecognizeResponse out = Answer();
  *out.mutable_detections(0)->mutable_grasps() = earlier.grasps();
  return out;
}

TEST(ReplayTest, AnswersOfEarlierServersAreComparedByWhatTheyHave) {
  const std::string top = R"pb(grasp_id: "top" gripper_opening_m: 0.04)pb";
  const auto bundle = BundleOf(EarlierAnswer("grasps {" + top + "}"));
  const std::string grasp = R"pb(grasp {
                                   grasp_id: "top"
                                   gripper_opening_m: 0.04
                                   tcp_pose {}
                                 })pb";
  EXPECT_TRUE(CompareReplay(bundle, EarlierAnswer("grasps {" + top + " " + grasp + "}")).is_same);
  const ReplayResult other = CompareReplay(bundle, EarlierAnswer(R"pb(grasps {
                                                                        grasp_id: "side"
                                                                        grasp {
                                                                          grasp_id: "side"
                                                                          tcp_pose {}
                                                                        }
                                                                      })pb"));
  EXPECT_THAT(other.differences, ElementsAre(HasSubstr("grasps top, now side")));
}

TEST(ReplayTest, TheLastBitCounts) {
  v1::RecognizeResponse now = Answer();
  const double x = 0.1;
  now.mutable_detections(0)->mutable_refined_pose()->mutable_position()->set_x(
      std::nextafter(x, 1.0));
  EXPECT_FALSE(CompareReplay(BundleOf(Answer()), now).is_same);
  now = Answer();
  now.mutable_detections(0)->set_point_count(1);
  const ReplayResult details = CompareReplay(BundleOf(Answer()), now);
  EXPECT_FALSE(details.is_same);
  EXPECT_THAT(details.differences, ElementsAre(HasSubstr("point_count")));
  now = Answer();
  now.mutable_stages(0)->set_input_point_count(1);
  EXPECT_THAT(CompareReplay(BundleOf(Answer()), now).differences,
              ElementsAre(HasSubstr("stages[0].input_point_count")));
}

TEST(ReplayTest, ErrorsAreComparedByCodeAndText) {
  v1::Bundle bundle;
  bundle.mutable_request();
  bundle.mutable_error()->set_code(static_cast<int>(absl::StatusCode::kInvalidArgument));
  bundle.mutable_error()->set_message("no measurement");
  bundle.set_catalog_revision(9);
  EXPECT_TRUE(CompareReplay(bundle, absl::InvalidArgumentError("no measurement")).is_same);
  EXPECT_FALSE(CompareReplay(bundle, absl::InvalidArgumentError("another")).is_same);
  EXPECT_FALSE(CompareReplay(bundle, absl::InternalError("no measurement")).is_same);
  const ReplayResult answered = CompareReplay(bundle, Answer());
  EXPECT_FALSE(answered.is_same);
  EXPECT_EQ(answered.revision_then, 9);
  EXPECT_THAT(answered.differences, ElementsAre("INVALID_ARGUMENT no measurement, now an answer"));
  EXPECT_THAT(CompareReplay(BundleOf(Answer()), absl::NotFoundError("gone")).differences,
              ElementsAre("an answer, now NOT_FOUND gone"));
}

}  // namespace
}  // namespace graspdb::client
