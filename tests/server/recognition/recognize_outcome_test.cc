// Responses without success, and the source of the world frame.
#include <gmock/gmock.h>

#include "tests/server/server_fixture.h"

namespace graspdb::testing {
namespace {

using ::testing::IsEmpty;

class RecognizeOutcomeTest : public ServerTest {};

TEST_F(RecognizeOutcomeTest, ARegionWithoutMeasurementsIsEmpty) {
  v1::RecognizeRequest request = RequestOf(PhotographEmptyTable());
  *request.mutable_region_of_interest() = BoxMessage({5, 5, 5}, {6, 6, 6});
  const v1::RecognizeResponse answer = Answer(request);
  EXPECT_EQ(answer.status(), v1::EMPTY_REGION);
  EXPECT_THAT(answer.detections(), IsEmpty());
}

TEST_F(RecognizeOutcomeTest, AnEmptyTableHasNoCluster) {
  const v1::RecognizeResponse answer = Answer(RequestOf(PhotographEmptyTable()));
  EXPECT_EQ(answer.status(), v1::NO_CLUSTER);
  EXPECT_THAT(answer.detections(), IsEmpty());
}

TEST_F(RecognizeOutcomeTest, EmptyCatalogueGivesUnknownObjects) {
  const v1::RecognizeResponse answer = Answer(RequestOf(Photograph("wedge", {.turn_deg = 10}, 3)));
  EXPECT_EQ(answer.status(), v1::UNKNOWN_OBJECT);
  EXPECT_EQ(answer.catalog_revision(), 0);
  ASSERT_EQ(answer.detections_size(), 1);
  EXPECT_EQ(answer.detections(0).status(), v1::UNKNOWN_OBJECT);
  EXPECT_EQ(answer.detections(0).object(), "");
  EXPECT_FALSE(answer.detections(0).has_refined_pose());
  EXPECT_FALSE(answer.detections(0).has_registration()) << "nothing was aligned";
}

TEST_F(RecognizeOutcomeTest, LowScoreIsUnknownWithoutAPose) {
  Teach("wedge", 2);
  v1::RecognizeRequest request = RequestOf(Photograph("flange", {.turn_deg = 10}, 3));
  request.mutable_pipeline()->set_min_score(1);
  const v1::RecognizeResponse answer = Answer(request);
  EXPECT_NE(answer.status(), v1::OK);
  ASSERT_EQ(answer.detections_size(), 1);
  EXPECT_EQ(answer.detections(0).object(), "");
  EXPECT_EQ(answer.detections(0).view(), "");
  EXPECT_FALSE(answer.detections(0).has_refined_pose());
  EXPECT_THAT(answer.detections(0).grasps(), IsEmpty());
  EXPECT_EQ(answer.detections(0).candidates_size(), 2);
}

TEST_F(RecognizeOutcomeTest, StablePoseWithoutGraspsIsRecognised) {
  Teach("wedge", 2);
  v1::UpdateStablePoseRequest update;
  update.mutable_stable_pose()->set_name(FlatPoseOf("wedge"));
  update.mutable_update_mask()->add_paths("grasps");
  ASSERT_THAT(Call(&Catalog::UpdateStablePose, update), IsGrpcOk());
  const v1::RecognizeResponse answer = Answer(RequestOf(Photograph("wedge", {}, 3)));
  EXPECT_EQ(answer.status(), v1::NO_GRASP);
  ASSERT_EQ(answer.detections_size(), 1);
  EXPECT_EQ(answer.detections(0).status(), v1::NO_GRASP);
  EXPECT_EQ(answer.detections(0).object(), "objects/wedge");
  EXPECT_TRUE(answer.detections(0).has_refined_pose());
}

TEST_F(RecognizeOutcomeTest, WorldFrameComesFromTheRequestIfGiven) {
  const Frame frame = Photograph("wedge", {}, 3);
  const v1::RecognizeResponse answer = Answer(RequestOf(frame));
  EXPECT_EQ(answer.world_frame_source(), v1::WORLD_FRAME_SOURCE_REQUEST);
  EXPECT_LT(ShiftBetween(frame.world_sensor, answer.sensor_pose()), 1e-9);
}

TEST_F(RecognizeOutcomeTest, WorldFrameComesFromTheTableByDefault) {
  v1::RecognizeRequest request = RequestOf(Photograph("wedge", {}, 3));
  request.clear_sensor_pose();
  const v1::RecognizeResponse answer = Answer(request);
  EXPECT_EQ(answer.world_frame_source(), v1::WORLD_FRAME_SOURCE_DOMINANT_PLANE);
  EXPECT_NEAR(answer.sensor_pose().position().z(), 0.65 * 0.7071, 0.01);
}

TEST_F(RecognizeOutcomeTest, ASegmentedScanWithoutPoseStaysInTheSensorFrame) {
  v1::RecognizeRequest request;
  *request.mutable_cloud() = SegmentedCloudOf("wedge", {}, 3);
  request.set_segmented(true);
  const v1::RecognizeResponse answer = Answer(request);
  EXPECT_EQ(answer.world_frame_source(), v1::WORLD_FRAME_SOURCE_SENSOR);
  EXPECT_LT(ShiftBetween(recognition::Pose::Identity(), answer.sensor_pose()), 1e-9);
}

}  // namespace
}  // namespace graspdb::testing
