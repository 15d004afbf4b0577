// The effect of a cell's settings on recognition.
#include <gmock/gmock.h>

#include "tests/server/server_fixture.h"

namespace graspdb::testing {
namespace {

class RecognizeCellTest : public ServerTest {
 protected:
  void SetUp() override {
    ServerTest::SetUp();
    Teach("wedge", 4);
    frame_ = Photograph("wedge", {.x = 0.03, .turn_deg = 10}, 3);
    request_ = RequestOf(frame_);
    request_.set_cell("cells/press");
    request_.clear_sensor_pose();
  }

  void MakeCell(const v1::Cell& cell) {
    v1::CreateCellRequest request;
    request.set_cell_id("press");
    *request.mutable_cell() = cell;
    ASSERT_THAT(Call(&Cells::CreateCell, request), IsGrpcOk());
  }

  Frame frame_;
  v1::RecognizeRequest request_;
};

TEST_F(RecognizeCellTest, CalibrationDefinesTheWorldFrame) {
  v1::Cell cell;
  *cell.mutable_sensor_pose() = PoseMessage(frame_.world_sensor);
  MakeCell(cell);
  const v1::RecognizeResponse answer = Answer(request_);
  EXPECT_EQ(answer.world_frame_source(), v1::WORLD_FRAME_SOURCE_CELL);
  ASSERT_EQ(answer.detections_size(), 1);
  EXPECT_LT(ShiftBetween(frame_.world_object, answer.detections(0).refined_pose()), 0.004);
}

TEST_F(RecognizeCellTest, PoseInTheRequestOverridesTheCalibration) {
  v1::Cell cell;
  recognition::Pose wrong = frame_.world_sensor;
  wrong.pretranslate(Eigen::Vector3d(0, 0, 0.2));
  *cell.mutable_sensor_pose() = PoseMessage(wrong);
  MakeCell(cell);
  *request_.mutable_sensor_pose() = PoseMessage(frame_.world_sensor);
  const v1::RecognizeResponse answer = Answer(request_);
  EXPECT_EQ(answer.world_frame_source(), v1::WORLD_FRAME_SOURCE_REQUEST);
  EXPECT_LT(ShiftBetween(frame_.world_sensor, answer.sensor_pose()), 1e-9);
}

TEST_F(RecognizeCellTest, CellWithoutCalibrationUsesTheTable) {
  MakeCell(v1::Cell());
  EXPECT_EQ(Answer(request_).world_frame_source(), v1::WORLD_FRAME_SOURCE_DOMINANT_PLANE);
}

TEST_F(RecognizeCellTest, ItsRegionAppliesUnlessTheRequestHasOne) {
  v1::Cell cell;
  *cell.mutable_sensor_pose() = PoseMessage(frame_.world_sensor);
  *cell.mutable_region_of_interest() = BoxMessage({5, 5, 5}, {6, 6, 6});
  MakeCell(cell);
  EXPECT_EQ(Answer(request_).status(), v1::EMPTY_REGION);
  *request_.mutable_region_of_interest() = BoxMessage({-0.3, -0.3, -0.02}, {0.3, 0.3, 0.4});
  EXPECT_EQ(Answer(request_).status(), v1::OK);
}

TEST_F(RecognizeCellTest, GraspsOutsideItsWorkspaceAreNotProposed) {
  v1::Cell cell;
  *cell.mutable_sensor_pose() = PoseMessage(frame_.world_sensor);
  *cell.mutable_workspace() = BoxMessage({1, 1, 0}, {2, 2, 1});
  MakeCell(cell);
  const v1::RecognizeResponse answer = Answer(request_);
  EXPECT_EQ(answer.status(), v1::OUT_OF_WORKSPACE);
  ASSERT_EQ(answer.detections_size(), 1);
  EXPECT_EQ(answer.detections(0).object(), "objects/wedge");
  EXPECT_EQ(answer.detections(0).grasps_size(), 0);
}

TEST_F(RecognizeCellTest, ItsSettingsApplyUnlessTheRequestHasThem) {
  v1::Cell cell;
  *cell.mutable_sensor_pose() = PoseMessage(frame_.world_sensor);
  cell.mutable_pipeline()->set_verified_view_count(1);
  cell.mutable_pipeline()->set_min_score(1);
  MakeCell(cell);
  const auto verified = [](const v1::RecognizeResponse& answer) {
    int count = 0;
    for (const v1::Candidate& candidate : answer.detections(0).candidates()) {
      count += candidate.has_verification_score() ? 1 : 0;
    }
    return count;
  };
  v1::RecognizeResponse answer = Answer(request_);
  EXPECT_EQ(answer.status(), v1::UNKNOWN_OBJECT);
  EXPECT_EQ(verified(answer), 1);
  request_.mutable_pipeline()->set_min_score(0.3);
  answer = Answer(request_);
  EXPECT_EQ(answer.status(), v1::OK);
  EXPECT_EQ(verified(answer), 1);
}

TEST_F(RecognizeCellTest, AnUnknownCellIsNotFound) {
  ExpectError(Call(&Recognition::Recognize, request_), grpc::StatusCode::NOT_FOUND, "cells/press");
}

TEST_F(RecognizeCellTest, AChangedCellAppliesToTheNextFrame) {
  v1::Cell cell;
  *cell.mutable_sensor_pose() = PoseMessage(frame_.world_sensor);
  MakeCell(cell);
  ASSERT_EQ(Answer(request_).status(), v1::OK);
  v1::UpdateCellRequest update;
  update.mutable_cell()->set_name("cells/press");
  *update.mutable_cell()->mutable_workspace() = BoxMessage({1, 1, 0}, {2, 2, 1});
  update.mutable_update_mask()->add_paths("workspace");
  ASSERT_THAT(Call(&Cells::UpdateCell, update), IsGrpcOk());
  EXPECT_EQ(Answer(request_).status(), v1::OUT_OF_WORKSPACE);
}

}  // namespace
}  // namespace graspdb::testing
