// Findings of `graspdb doctor`.
#include "client/cli/objects/doctor_checks.h"

#include <gmock/gmock.h>
#include <google/protobuf/util/time_util.h>

#include <vector>

#include "absl/time/clock.h"

namespace graspdb::client {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

MATCHER_P2(Finds, severity, words, "") {
  return arg.severity == severity && arg.text.find(words) != std::string::npos;
}

v1::CatalogStatus GoodStatus() {
  v1::CatalogStatus status;
  status.set_server_version("1.2.3");
  status.set_view_count(10);
  return status;
}

v1::StablePose GoodPose() {
  v1::StablePose pose;
  pose.set_name("objects/mug/stablePoses/upright");
  pose.add_grasps()->set_gripper_opening_m(0.05);
  return pose;
}

void SetBox(double half, double x, v1::AxisAlignedBox* box) {
  for (auto [corner, sign] : {std::pair(box->mutable_min(), -1), {box->mutable_max(), 1}}) {
    corner->set_x(x + sign * half);
    corner->set_y(sign * half);
    corner->set_z(sign * half);
  }
}

v1::Cell GoodCell() {
  v1::Cell cell;
  cell.set_name("cells/press-3");
  cell.mutable_sensor_pose()->mutable_position()->set_z(0.8);
  SetBox(0.3, 0, cell.mutable_region_of_interest());
  SetBox(0.5, 0, cell.mutable_workspace());
  return cell;
}

TEST(DoctorChecks, NothingIsWrongWithAGoodCatalogue) {
  Findings out;
  CheckServer(GoodStatus(), "1.2.3", &out);
  CheckObject(v1::Object(), {GoodPose()}, &out);
  CheckStablePose(GoodPose(), 12, {}, &out);
  CheckThreshold(GoodPose(), std::vector<v1::View>(12), &out);
  CheckProposal(GoodPose(), v1::ThresholdProposal(), &out);
  CheckCell(GoodCell(), &out);
  CheckUpload(v1::Upload(), absl::Now(), &out);
  EXPECT_THAT(out, IsEmpty());
}

TEST(DoctorChecks, ServerWithAnotherVersionAndRecordsThatCannotBeUsed) {
  v1::CatalogStatus status = GoodStatus();
  status.set_left_out_record_count(2);
  status.mutable_memory()->set_refused_request_count(7);
  status.set_view_count(0);
  Findings out;
  CheckServer(status, "1.2.4", &out);
  EXPECT_THAT(out, ElementsAre(Finds(Severity::kWarning, "1.2.3"), Finds(Severity::kError, "2 rec"),
                               Finds(Severity::kWarning, "7 requests"),
                               Finds(Severity::kWarning, "empty")));
}

TEST(DoctorChecks, StablePosesThatAreNeverRecognized) {
  Findings out;
  CheckObject(v1::Object(), {}, &out);
  v1::StablePose pose = GoodPose();
  pose.clear_grasps();
  CheckStablePose(pose, 0, {}, &out);
  CheckStablePose(GoodPose(), 3, {}, &out);
  pose = GoodPose();
  pose.set_symmetry_order(0);
  CheckStablePose(pose, 1, {}, &out);
  pose.set_symmetry_order(4);
  CheckStablePose(pose, 2, {}, &out);
  CheckStablePose(pose, 1, {}, &out);
  EXPECT_THAT(
      out, ElementsAre(Finds(Severity::kWarning, "no stable pose"),
                       Finds(Severity::kWarning, "no views"), Finds(Severity::kAdvice, "no grasps"),
                       Finds(Severity::kAdvice, "only 3 views"),
                       Finds(Severity::kAdvice, "only 1 view;")));
}

TEST(DoctorChecks, AStablePoseWhoseViewsAreInAnOpenUploadIsNotToBeDeleted) {
  Findings out;
  CheckStablePose(GoodPose(), 0, {"uploads/import-7", true}, &out);
  EXPECT_THAT(out, ElementsAre(Finds(Severity::kAdvice, "uploads/import-7, which is open")));
  EXPECT_THAT(out.front().text, ::testing::Not(::testing::HasSubstr("delete")));
}

TEST(DoctorChecks, AStablePoseWithoutViewsIsNoMistakeWhileAnImportRuns) {
  v1::Upload upload;
  upload.set_name("uploads/import-7");
  upload.set_state(v1::UPLOAD_STATE_OPEN);
  upload.set_expected_view_count(3);
  upload.set_staged_view_count(1);
  upload.set_failed_view_count(1);
  EXPECT_TRUE(IsInProgress(upload, absl::UnixEpoch() + absl::Hours(1)));
  EXPECT_FALSE(IsInProgress(upload, absl::UnixEpoch() + absl::Hours(25)));
  Findings out;
  CheckStablePose(GoodPose(), 0, {upload.name(), false}, &out);
  EXPECT_THAT(out, ElementsAre(Finds(Severity::kAdvice, "uploads/import-7 is in progress")));
  upload.set_staged_view_count(2);
  EXPECT_FALSE(IsInProgress(upload, absl::UnixEpoch() + absl::Hours(1)));
}

TEST(DoctorChecks, ViewsThatAreNewerThanTheMinimumScore) {
  using google::protobuf::util::TimeUtil;
  v1::StablePose pose = GoodPose();
  *pose.mutable_update_time() = TimeUtil::SecondsToTimestamp(1000);
  std::vector<v1::View> views(2);
  *views[0].mutable_create_time() = TimeUtil::SecondsToTimestamp(999);
  *views[1].mutable_create_time() = TimeUtil::SecondsToTimestamp(1001);
  Findings out;
  CheckThreshold(pose, views, &out);
  EXPECT_THAT(out, IsEmpty());
  pose.set_min_score(0.4);
  CheckThreshold(pose, views, &out);
  EXPECT_THAT(out, ElementsAre(Finds(Severity::kAdvice, "1 view is newer")));
  EXPECT_THAT(out.front().text, ::testing::HasSubstr("graspdb objects thresholds objects/mug"));
}

TEST(DoctorChecks, MinimumScoresThatTheViewsDoNotCallFor) {
  v1::StablePose pose = GoodPose();
  v1::ThresholdProposal proposal;
  proposal.set_min_score(0.36);
  Findings out;
  CheckProposal(pose, proposal, &out);
  pose.set_min_score(0.361);
  CheckProposal(pose, proposal, &out);
  pose.set_min_score(0.5);
  CheckProposal(pose, proposal, &out);
  pose.set_min_score(0.2);
  CheckProposal(pose, proposal, &out);
  proposal.clear_min_score();
  CheckProposal(pose, proposal, &out);
  EXPECT_THAT(out, ElementsAre(Finds(Severity::kWarning, "has the default minimum score"),
                               Finds(Severity::kWarning, "0.50, where its views call for 0.36"),
                               Finds(Severity::kAdvice, "0.20, where its views call for 0.36"),
                               Finds(Severity::kAdvice, "call for the default")));
}

TEST(DoctorChecks, CellsWithoutCalibrationOrInMillimetres) {
  Findings out;
  CheckCell(v1::Cell(), &out);
  v1::Cell cell = GoodCell();
  SetBox(300, 0, cell.mutable_region_of_interest());
  CheckCell(cell, &out);
  cell = GoodCell();
  SetBox(0.2, 2, cell.mutable_workspace());
  CheckCell(cell, &out);
  EXPECT_THAT(out, ElementsAre(Finds(Severity::kWarning, "no calibration"),
                               Finds(Severity::kWarning, "no region"),
                               Finds(Severity::kError, "not millimetres"),
                               Finds(Severity::kError, "do not overlap")));
}

TEST(DoctorChecks, PlacesOfACellInMillimetresOrBelowTheTable) {
  v1::Cell cell = GoodCell();
  cell.mutable_sensor_pose()->mutable_position()->set_y(-500);
  cell.mutable_robot_base_pose()->mutable_position()->set_x(600);
  SetBox(500, 0, cell.mutable_workspace());
  Findings out;
  CheckCell(cell, &out);
  EXPECT_THAT(out, ElementsAre(Finds(Severity::kError, "camera is 500"),
                               Finds(Severity::kError, "robot is 600 m"),
                               Finds(Severity::kError, "workspace is 1000 m")));
  cell = GoodCell();
  cell.clear_sensor_pose();
  cell.mutable_flange_sensor_pose()->mutable_position()->set_z(80);
  out.clear();
  CheckCell(cell, &out);
  EXPECT_THAT(out, ElementsAre(Finds(Severity::kError, "flange is 80 m")));
  cell = GoodCell();
  cell.mutable_sensor_pose()->mutable_position()->set_z(-1);
  out.clear();
  CheckCell(cell, &out);
  EXPECT_THAT(out, ElementsAre(Finds(Severity::kWarning, "not above the table")));
}

TEST(DoctorChecks, ARegionThatTheCameraDoesNotSee) {
  v1::Cell cell = GoodCell();
  Findings out;
  cell.mutable_sensor_pose()->mutable_position()->set_z(1);
  v1::Quaternion* orientation = cell.mutable_sensor_pose()->mutable_orientation();
  orientation->set_x(1);  // looks down
  orientation->set_w(0);
  CheckCameraView(cell, &out);
  EXPECT_THAT(out, IsEmpty());
  orientation->set_x(0);  // looks up
  orientation->set_w(1);
  CheckCameraView(cell, &out);
  EXPECT_THAT(out, ElementsAre(Finds(Severity::kError, "does not see its region")));
  orientation->set_x(1);
  orientation->set_w(0);
  SetBox(0.2, 30, cell.mutable_region_of_interest());  // far beside it
  out.clear();
  CheckCameraView(cell, &out);
  EXPECT_THAT(out, ElementsAre(Finds(Severity::kError, "does not see its region")));
}

TEST(DoctorChecks, AMinimumScoreThatNothingReaches) {
  v1::Cell cell = GoodCell();
  Findings out;
  cell.mutable_pipeline()->set_min_score(0.99);
  CheckMinScore(cell, &out);
  EXPECT_THAT(out, IsEmpty());
  cell.mutable_pipeline()->set_min_score(1);
  CheckMinScore(cell, &out);
  EXPECT_THAT(out, ElementsAre(Finds(Severity::kError, "minimum score is 1")));
}

TEST(DoctorChecks, ACellWithLabelsOfNoObject) {
  v1::Cell cell = GoodCell();
  Findings out;
  CheckLabels(cell, {}, &out);
  cell.add_labels("line-1");
  cell.add_labels("line-2");
  CheckLabels(cell, {"line-2", "line-3"}, &out);
  EXPECT_THAT(out, IsEmpty());
  CheckLabels(cell, {"line-3"}, &out);
  EXPECT_THAT(out, ElementsAre(Finds(Severity::kError, "(line-1, line-2)")));
}

TEST(DoctorChecks, GraspsInMillimetres) {
  v1::StablePose pose = GoodPose();
  v1::Grasp* far = pose.add_grasps();
  far->set_gripper_opening_m(0.05);
  far->mutable_tcp_pose()->mutable_position()->set_z(30);
  pose.add_grasps()->set_gripper_opening_m(5);
  Findings out;
  CheckStablePose(pose, 12, {}, &out);
  EXPECT_THAT(out, ElementsAre(Finds(Severity::kError, "length of 30 m"),
                               Finds(Severity::kError, "length of 5 m")));
}

TEST(DoctorChecks, ForgottenUploads) {
  const absl::Time now = absl::FromUnixSeconds(1'800'000'000);
  v1::Upload upload;
  upload.set_state(v1::UPLOAD_STATE_OPEN);
  *upload.mutable_create_time() = google::protobuf::util::TimeUtil::SecondsToTimestamp(
      absl::ToUnixSeconds(now - absl::Hours(30)));
  Findings out;
  CheckUpload(upload, now - absl::Hours(20), &out);
  EXPECT_THAT(out, IsEmpty());
  CheckUpload(upload, now, &out);
  EXPECT_THAT(out, ElementsAre(Finds(Severity::kAdvice, "uploads delete")));
}

}  // namespace
}  // namespace graspdb::client
