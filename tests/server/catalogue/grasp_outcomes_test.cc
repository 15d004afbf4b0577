// Reports of grasp outcomes, through the CatalogService, and their effect on responses.
#include <gmock/gmock.h>

#include "tests/server/server_fixture.h"

namespace graspdb::testing {
namespace {

class GraspOutcomesTest : public ServerTest {
 protected:
  grpc::Status Report(const std::string& grasp, v1::GraspOutcome outcome, std::optional<int> count,
                      v1::ReportGraspOutcomeResponse* response) {
    v1::ReportGraspOutcomeRequest request;
    request.set_name(FlatPoseOf("wedge"));
    request.set_grasp_id(grasp);
    request.set_outcome(outcome);
    if (count) request.set_count(*count);
    return Call(&Catalog::ReportGraspOutcome, request, response);
  }

  void MustReport(const std::string& grasp, v1::GraspOutcome outcome, int count) {
    v1::ReportGraspOutcomeResponse response;
    ASSERT_THAT(Report(grasp, outcome, count, &response), IsGrpcOk());
  }

  v1::ReportGraspOutcomeRequest MissedWithRequestId() {
    v1::ReportGraspOutcomeRequest request;
    request.set_name(FlatPoseOf("wedge"));
    request.set_grasp_id(Pose().grasps(0).grasp_id());
    request.set_outcome(v1::GRASP_OUTCOME_MISSED);
    request.set_request_id("123e4567-e89b-42d3-a456-426614174000");
    return request;
  }

  v1::StablePose Pose() {
    v1::GetStablePoseRequest request;
    request.set_name(FlatPoseOf("wedge"));
    v1::StablePose pose;
    EXPECT_THAT(Call(&Catalog::GetStablePose, request, &pose), IsGrpcOk());
    return pose;
  }

  // Two grasps of one priority, the first one first.
  void TeachTwoGrasps() {
    Teach("wedge", 6);
    v1::UpdateStablePoseRequest request;
    *request.mutable_stable_pose() = Pose();
    v1::Grasp grasp = request.stable_pose().grasps(0);
    request.mutable_stable_pose()->clear_grasps();
    for (const char* id : {"first", "second"}) {
      grasp.set_grasp_id(id);
      *request.mutable_stable_pose()->add_grasps() = grasp;
    }
    ASSERT_THAT(Call(&Catalog::UpdateStablePose, request), IsGrpcOk());
  }

  std::string FirstGrasp() {
    const v1::RecognizeResponse answer =
        Answer(RequestOf(Photograph("wedge", {0.02, 0.01, 15}, 1)));
    EXPECT_EQ(answer.detections_size(), 1);
    if (answer.detections().empty() || answer.detections(0).grasps().empty()) return "";
    return answer.detections(0).grasps(0).grasp().grasp_id();
  }
};

TEST_F(GraspOutcomesTest, ReportCountsOnceByDefault) {
  Declare("wedge");
  const std::string grasp = Pose().grasps(0).grasp_id();
  v1::ReportGraspOutcomeResponse response;
  ASSERT_THAT(Report(grasp, v1::GRASP_OUTCOME_PICKED, std::nullopt, &response), IsGrpcOk());
  EXPECT_EQ(response.counts().picked_count(), 1);
  ASSERT_THAT(Report(grasp, v1::GRASP_OUTCOME_SLIPPED, 3, &response), IsGrpcOk());
  EXPECT_EQ(response.counts().slipped_count(), 3);
  EXPECT_EQ(response.catalog_revision(), Status().catalog_revision());
  const v1::CatalogStatus status = Status();
  EXPECT_EQ(status.picked_count(), 1);
  EXPECT_EQ(status.missed_count(), 0);
  EXPECT_EQ(status.slipped_count(), 3);
}

TEST_F(GraspOutcomesTest, CountsAreReturnedAndTheEtagIsUnchanged) {
  Declare("wedge");
  const v1::StablePose before = Pose();
  EXPECT_EQ(before.grasp_outcomes_size(), 0);
  MustReport(before.grasps(0).grasp_id(), v1::GRASP_OUTCOME_MISSED, 2);
  const v1::StablePose after = Pose();
  EXPECT_EQ(after.etag(), before.etag());
  ASSERT_EQ(after.grasp_outcomes_size(), 1);
  EXPECT_EQ(after.grasp_outcomes(0).missed_count(), 2);
  v1::ListStablePosesRequest request;
  request.set_parent("objects/wedge");
  v1::ListStablePosesResponse page;
  ASSERT_THAT(Call(&Catalog::ListStablePoses, request, &page), IsGrpcOk());
  EXPECT_EQ(page.stable_poses(0).SerializeAsString(), after.SerializeAsString());
}

TEST_F(GraspOutcomesTest, InvalidReportsAreRejected) {
  Declare("wedge");
  const std::string grasp = Pose().grasps(0).grasp_id();
  v1::ReportGraspOutcomeResponse response;
  ExpectError(Report("none", v1::GRASP_OUTCOME_PICKED, 1, &response), grpc::StatusCode::NOT_FOUND,
              "no grasp 'none'");
  ExpectError(Report(grasp, v1::GRASP_OUTCOME_UNSPECIFIED, 1, &response),
              grpc::StatusCode::INVALID_ARGUMENT, "outcome");
  for (const int count : {0, -1, 10'001}) {
    ExpectError(Report(grasp, v1::GRASP_OUTCOME_PICKED, count, &response),
                grpc::StatusCode::INVALID_ARGUMENT, "count");
  }
  v1::ReportGraspOutcomeRequest request;
  request.set_name("objects/none/stablePoses/flat");
  request.set_outcome(v1::GRASP_OUTCOME_PICKED);
  ExpectError(Call(&Catalog::ReportGraspOutcome, request, &response), grpc::StatusCode::NOT_FOUND,
              "objects/none");
}

TEST_F(GraspOutcomesTest, ARepeatedReportCountsOnceAlsoAfterARestart) {
  Declare("wedge");
  v1::ReportGraspOutcomeRequest request = MissedWithRequestId();
  v1::ReportGraspOutcomeResponse first;
  ASSERT_THAT(Call(&Catalog::ReportGraspOutcome, request, &first), IsGrpcOk());
  MustReport(request.grasp_id(), v1::GRASP_OUTCOME_PICKED, 1);
  for (const char* id :
       {"123e4567-e89b-42d3-a456-426614174000", "123E4567-E89B-42D3-A456-426614174000"}) {
    request.set_request_id(id);
    v1::ReportGraspOutcomeResponse again;
    ASSERT_THAT(Call(&Catalog::ReportGraspOutcome, request, &again), IsGrpcOk());
    EXPECT_EQ(again.SerializeAsString(), first.SerializeAsString());
    EXPECT_EQ(Status().missed_count(), 1);
    Restart();
  }
  request.set_request_id("00000000-e89b-42d3-a456-426614174000");
  ASSERT_THAT(Call(&Catalog::ReportGraspOutcome, request), IsGrpcOk());
  EXPECT_EQ(Status().missed_count(), 2);
}

TEST_F(GraspOutcomesTest, AnIdOfAnotherReportIsRejected) {
  Declare("wedge");
  v1::ReportGraspOutcomeRequest request = MissedWithRequestId();
  ASSERT_THAT(Call(&Catalog::ReportGraspOutcome, request), IsGrpcOk());
  request.set_outcome(v1::GRASP_OUTCOME_PICKED);
  const grpc::Status status = Call(&Catalog::ReportGraspOutcome, request);
  ExpectError(status, grpc::StatusCode::ALREADY_EXISTS, "another request");
  EXPECT_EQ(ReasonOf(status), "REQUEST_ID_REUSED");
  request.set_request_id("123e4567-e89b-12d3-a456-426614174000");
  ExpectError(Call(&Catalog::ReportGraspOutcome, request), grpc::StatusCode::INVALID_ARGUMENT,
              "request_id: must be a UUID");
  EXPECT_EQ(Status().picked_count(), 0);
}

TEST_F(GraspOutcomesTest, FailingGraspIsProposedLaterAlsoAfterARestart) {
  TeachTwoGrasps();
  EXPECT_EQ(FirstGrasp(), "first");
  MustReport("first", v1::GRASP_OUTCOME_MISSED, 5);
  EXPECT_EQ(FirstGrasp(), "second");
  Restart();
  EXPECT_EQ(FirstGrasp(), "second");
  MustReport("second", v1::GRASP_OUTCOME_SLIPPED, 20);
  EXPECT_EQ(FirstGrasp(), "first");
}

TEST_F(GraspOutcomesTest, ChangedGraspStartsAtZero) {
  TeachTwoGrasps();
  MustReport("first", v1::GRASP_OUTCOME_MISSED, 5);
  v1::UpdateStablePoseRequest request;
  *request.mutable_stable_pose() = Pose();
  request.mutable_stable_pose()->set_symmetry_order(1);
  ASSERT_THAT(Call(&Catalog::UpdateStablePose, request), IsGrpcOk());
  EXPECT_EQ(FirstGrasp(), "second") << "another change keeps the outcomes";
  *request.mutable_stable_pose() = Pose();
  request.mutable_stable_pose()->mutable_grasps(0)->set_gripper_opening_m(0.07);
  ASSERT_THAT(Call(&Catalog::UpdateStablePose, request), IsGrpcOk());
  EXPECT_EQ(FirstGrasp(), "first");
}

TEST_F(GraspOutcomesTest, TheSameRevisionGivesTheSameBytes) {
  TeachTwoGrasps();
  MustReport("first", v1::GRASP_OUTCOME_MISSED, 5);
  const v1::RecognizeRequest request = RequestOf(Photograph("wedge", {0.02, 0.01, 15}, 1));
  EXPECT_EQ(Answer(request).SerializeAsString(), Answer(request).SerializeAsString());
}

}  // namespace
}  // namespace graspdb::testing
