// Recognize with a taught catalogue.
#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <google/protobuf/util/message_differencer.h>

#include <cmath>
#include <numbers>
#include <string>

#include "files/messages/pose_message.h"
#include "tests/server/server_fixture.h"

namespace graspdb::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

using google::protobuf::util::MessageDifferencer;

std::string Text(const google::protobuf::Message& message,
                 const google::protobuf::FieldDescriptor* field) {
  std::string out;
  google::protobuf::TextFormat::PrintFieldValueToString(message, field, -1, &out);
  return out;
}

class RecognizeTest : public ServerTest {};

TEST_F(RecognizeTest, TaughtObjectIsFoundAtItsPose) {
  Teach("wedge", 8);
  Teach("handle", 8);
  for (const char* part : {"wedge", "handle"}) {
    const Frame frame = Photograph(part, {.x = 0.05, .y = -0.03, .turn_deg = 70}, 11);
    const v1::RecognizeResponse answer = Answer(RequestOf(frame));
    EXPECT_EQ(answer.status(), v1::OK);
    EXPECT_EQ(answer.catalog_revision(), Status().catalog_revision());
    ASSERT_EQ(answer.detections_size(), 1);
    const v1::Detection& detection = answer.detections(0);
    EXPECT_EQ(detection.object(), "objects/" + std::string(part));
    EXPECT_EQ(detection.stable_pose(), FlatPoseOf(part));
    EXPECT_THAT(detection.view(), ::testing::StartsWith(FlatPoseOf(part) + "/views/turn-"));
    EXPECT_LT(ShiftBetween(frame.world_object, detection.refined_pose()), 0.004);
    EXPECT_LT(ShiftBetween(frame.world_object, detection.rough_pose()), 0.03);
    EXPECT_GT(detection.score(), 0.7);
    EXPECT_LE(detection.score(), 1);
    EXPECT_EQ(detection.candidates_size(), 10);
    EXPECT_GT(detection.point_count(), 50);
  }
}

TEST_F(RecognizeTest, ModelsAreKeptInMemory) {
  Teach("wedge", 8);
  const v1::RecognizeRequest request = RequestOf(Photograph("wedge", {.turn_deg = 20}, 3));
  Answer(request);
  const v1::CatalogStatus first = Status();
  EXPECT_GE(first.cloud_cache().miss_count(), 8);
  EXPECT_GT(first.model_cache().byte_count(), 0);
  Answer(request);
  EXPECT_GT(Status().model_cache().hit_count(), first.model_cache().hit_count());
}

TEST_F(RecognizeTest, CandidatesAreSortedByDistance) {
  Teach("wedge", 8);
  const v1::RecognizeResponse answer = Answer(RequestOf(Photograph("wedge", {.turn_deg = 20}, 3)));
  ASSERT_EQ(answer.detections_size(), 1);
  const auto& candidates = answer.detections(0).candidates();
  ASSERT_EQ(candidates.size(), 8);
  for (int i = 1; i < candidates.size(); ++i) {
    EXPECT_LE(candidates[i - 1].descriptor_distance(), candidates[i].descriptor_distance());
  }
}

TEST_F(RecognizeTest, GraspsAreTransformedAndSortedByPriority) {
  Teach("handle", 6);
  v1::UpdateStablePoseRequest update;
  update.mutable_stable_pose()->set_name(FlatPoseOf("handle"));
  for (int priority : {1, 3, 2}) {
    v1::Grasp* grasp = update.mutable_stable_pose()->add_grasps();
    *grasp = Part("handle").grasps[0];
    grasp->set_grasp_id("p" + std::to_string(priority));
    grasp->set_priority(priority);
  }
  update.mutable_update_mask()->add_paths("grasps");
  ASSERT_THAT(Call(&Catalog::UpdateStablePose, update), IsGrpcOk());
  const Frame frame = Photograph("handle", {.x = -0.04, .turn_deg = 130}, 5);
  const v1::RecognizeResponse answer = Answer(RequestOf(frame));
  ASSERT_EQ(answer.detections_size(), 1);
  std::vector<std::string> ids;
  for (const v1::GraspProposal& proposal : answer.detections(0).grasps()) {
    ids.push_back(proposal.grasp().grasp_id());
  }
  EXPECT_THAT(ids, ElementsAre("p3", "p2", "p1"));
  const v1::Vector3& in_object = Part("handle").grasps[0].tcp_pose().position();
  recognition::Pose truth = frame.world_object;
  truth.translate(Eigen::Vector3d(in_object.x(), in_object.y(), in_object.z()));
  EXPECT_LT(ShiftBetween(truth, answer.detections(0).grasps(0).tcp_pose()), 0.006);
}

TEST_F(RecognizeTest, AProposalHasTheGraspAsTaught) {
  Teach("handle", 6);
  v1::UpdateStablePoseRequest update;
  update.mutable_stable_pose()->set_name(FlatPoseOf("handle"));
  v1::Grasp& taught = *update.mutable_stable_pose()->add_grasps();
  taught = Part("handle").grasps[0];
  taught.set_grasp_id("grip");
  taught.set_approach_distance_m(0.11);
  taught.set_gripper_opening_m(0.07);
  taught.set_retreat_distance_m(0.13);
  taught.set_priority(5);
  taught.mutable_free_turn()->set_min_deg(-20);
  taught.mutable_free_turn()->set_max_deg(29.7);
  update.mutable_update_mask()->add_paths("grasps");
  ASSERT_THAT(Call(&Catalog::UpdateStablePose, update), IsGrpcOk());
  const v1::RecognizeResponse answer = Answer(RequestOf(Photograph("handle", {.x = 0.02}, 5)));
  ASSERT_EQ(answer.detections_size(), 1);
  ASSERT_GE(answer.detections(0).grasps_size(), 3) << "as taught, and both ends of the free turn";
  for (const v1::GraspProposal& proposal : answer.detections(0).grasps()) {
    v1::Grasp grasp = proposal.grasp();
    EXPECT_LT(ShiftBetween(files::FromMessage(taught.tcp_pose()), grasp.tcp_pose()), 1e-9);
    *grasp.mutable_tcp_pose() = taught.tcp_pose();
    EXPECT_TRUE(MessageDifferencer::Equals(grasp, taught)) << grasp.DebugString();
    // What earlier clients read.
    const auto* fields = v1::GraspProposal::descriptor();
    for (int i = 0; i < fields->field_count(); ++i) {
      if (!fields->field(i)->options().deprecated()) continue;
      const auto* field = v1::Grasp::descriptor()->FindFieldByName(fields->field(i)->name());
      ASSERT_NE(field, nullptr);
      EXPECT_EQ(Text(proposal, fields->field(i)), Text(taught, field)) << field->name();
    }
  }
}

TEST_F(RecognizeTest, MeshFrameIsTransformed) {
  Teach("wedge", 8);
  const Frame frame = Photograph("wedge", {.x = 0.05, .y = -0.03, .turn_deg = 70}, 11);
  EXPECT_FALSE(Answer(RequestOf(frame)).detections(0).has_mesh_pose());
  recognition::Pose object_mesh = recognition::Pose::Identity();
  object_mesh.translation() = Eigen::Vector3d(0.1, -0.2, 0.05);
  object_mesh.rotate(Eigen::AngleAxisd(2, Eigen::Vector3d(1, 2, 3).normalized()));
  v1::UpdateStablePoseRequest update;
  update.mutable_stable_pose()->set_name(FlatPoseOf("wedge"));
  *update.mutable_stable_pose()->mutable_mesh_pose() = files::ToMessage(object_mesh);
  update.mutable_update_mask()->add_paths("mesh_pose");
  ASSERT_THAT(Call(&Catalog::UpdateStablePose, update), IsGrpcOk());
  const v1::RecognizeResponse answer = Answer(RequestOf(frame));
  ASSERT_EQ(answer.detections_size(), 1);
  const v1::Detection& detection = answer.detections(0);
  EXPECT_LT(ShiftBetween(files::FromMessage(detection.refined_pose()) * object_mesh,
                         detection.mesh_pose()),
            1e-9);
  // A point of the mesh is at its true position in the world.
  const Eigen::Vector3d in_mesh = object_mesh.inverse() * Eigen::Vector3d(0.03, 0, 0.02);
  EXPECT_LT((files::FromMessage(detection.mesh_pose()) * in_mesh -
             frame.world_object * Eigen::Vector3d(0.03, 0, 0.02))
                .norm(),
            0.006);
}

TEST_F(RecognizeTest, UploadedViewIsFoundByTheNextCall) {
  Declare("wedge");
  const v1::RecognizeRequest request = RequestOf(Photograph("wedge", {.turn_deg = 5}, 3));
  EXPECT_EQ(Answer(request).status(), v1::UNKNOWN_OBJECT);
  ASSERT_THAT(Upload(ViewOf("wedge", 0, "only")), IsGrpcOk());
  const v1::RecognizeResponse found = Answer(request);
  EXPECT_EQ(found.status(), v1::OK);
  ASSERT_EQ(found.detections_size(), 1);
  EXPECT_EQ(found.detections(0).view(), FlatPoseOf("wedge") + "/views/only");
}

TEST_F(RecognizeTest, DeletedObjectIsNotFoundByTheNextCall) {
  Teach("wedge", 4);
  const v1::RecognizeRequest request = RequestOf(Photograph("wedge", {.turn_deg = 5}, 3));
  ASSERT_EQ(Answer(request).status(), v1::OK);
  v1::DeleteObjectRequest remove;
  remove.set_name("objects/wedge");
  remove.set_force(true);
  ASSERT_THAT(Call(&Catalog::DeleteObject, remove), IsGrpcOk());
  const v1::RecognizeResponse answer = Answer(request);
  EXPECT_EQ(answer.status(), v1::UNKNOWN_OBJECT);
  ASSERT_EQ(answer.detections_size(), 1);
  EXPECT_THAT(answer.detections(0).candidates(), IsEmpty());
}

TEST_F(RecognizeTest, DeletedViewIsNoCandidateInTheNextCall) {
  Teach("wedge", 2);
  v1::DeleteViewRequest remove;
  remove.set_name(FlatPoseOf("wedge") + "/views/turn-0");
  ASSERT_THAT(Call(&Catalog::DeleteView, remove), IsGrpcOk());
  const v1::RecognizeResponse answer = Answer(RequestOf(Photograph("wedge", {.turn_deg = 0}, 3)));
  ASSERT_EQ(answer.detections_size(), 1);
  ASSERT_EQ(answer.detections(0).candidates_size(), 1);
  EXPECT_EQ(answer.detections(0).candidates(0).view(), FlatPoseOf("wedge") + "/views/turn-1");
}

TEST_F(RecognizeTest, AReplacedViewIsMatchedWithItsNewCloud) {
  Declare("wedge");
  ASSERT_THAT(Upload(ViewOf("wedge", 0, "v")), IsGrpcOk());
  const v1::RecognizeRequest request = RequestOf(Photograph("wedge", {.turn_deg = 90}, 3));
  const double before = Answer(request).detections(0).candidates(0).descriptor_distance();
  v1::DeleteViewRequest remove;
  remove.set_name(FlatPoseOf("wedge") + "/views/v");
  ASSERT_THAT(Call(&Catalog::DeleteView, remove), IsGrpcOk());
  ASSERT_THAT(Upload(ViewOf("wedge", 90, "v")), IsGrpcOk());
  const v1::RecognizeResponse after = Answer(request);
  EXPECT_EQ(after.status(), v1::OK);
  EXPECT_LT(after.detections(0).candidates(0).descriptor_distance(), 0.2 * before);
  const v1::Quaternion& turn = after.detections(0).refined_pose().orientation();
  EXPECT_NEAR(2 * std::atan2(turn.z(), turn.w()), std::numbers::pi / 2, 0.05);
}

TEST_F(RecognizeTest, DepthImageGivesTheResponseOfItsCloud) {
  Teach("wedge", 4);
  const Frame frame = Photograph("wedge", {.x = 0.02, .turn_deg = 33}, 3);
  const v1::RecognizeRequest cloud = RequestOf(frame);
  v1::RecognizeRequest image = cloud;
  *image.mutable_depth_image() = DepthImageOf(frame);
  ASSERT_FALSE(image.has_cloud());
  const v1::RecognizeResponse answer = Answer(image);
  EXPECT_EQ(answer.status(), v1::OK);
  EXPECT_EQ(answer.SerializeAsString(), Answer(cloud).SerializeAsString());
}

TEST_F(RecognizeTest, SaturatedCountsOfADepthImageAreNoMeasurement) {
  Teach("wedge", 4);
  v1::RecognizeRequest request = RequestOf(Photograph("wedge", {.x = 0.02, .turn_deg = 33}, 3));
  *request.mutable_depth_image() =
      DepthImageOf(Photograph("wedge", {.x = 0.02, .turn_deg = 33}, 3));
  std::string& data = *request.mutable_depth_image()->mutable_data();
  for (std::size_t i = 0; i < data.size(); i += 14) data[i] = data[i + 1] = 0;
  const v1::RecognizeResponse answer = Answer(request);
  EXPECT_EQ(answer.status(), v1::OK);
  int saturated = 0;
  for (std::size_t i = 0; i < data.size(); i += 2) {
    if (data[i] != 0 || data[i + 1] != 0) continue;
    data[i] = data[i + 1] = static_cast<char>(0xFF);
    ++saturated;
  }
  EXPECT_GT(saturated, 1000);
  EXPECT_EQ(Answer(request).SerializeAsString(), answer.SerializeAsString());
}

TEST_F(RecognizeTest, WithoutTimingsTheSameScanGivesTheSameBytes) {
  Teach("wedge", 4);
  const v1::RecognizeRequest request = RequestOf(Photograph("wedge", {.turn_deg = 33}, 3));
  const v1::RecognizeResponse first = Answer(request);
  ASSERT_EQ(first.status(), v1::OK);
  EXPECT_EQ(Answer(request).SerializeAsString(), first.SerializeAsString());
  Restart();
  EXPECT_EQ(Answer(request).SerializeAsString(), first.SerializeAsString());
}

TEST_F(RecognizeTest, TimingsAndTheIdOfTheCatalogueAreReturnedByDefault) {
  Teach("wedge", 2);
  v1::RecognizeRequest request = RequestOf(Photograph("wedge", {.turn_deg = 33}, 3));
  EXPECT_FALSE(Answer(request).has_timings());
  EXPECT_EQ(Answer(request).catalog_id(), "");
  request.set_omit_timings(false);
  const v1::RecognizeResponse answer = Answer(request);
  EXPECT_EQ(answer.catalog_id(), Status().catalog_id());
  EXPECT_GT(answer.timings().total_ms(), answer.timings().register_ms());
  EXPECT_GT(answer.timings().register_ms(), 0);
  std::vector<std::string> stages;
  double segment_ms = 0;
  double register_ms = 0;
  for (const v1::StageReport& stage : answer.stages()) {
    if (stages.size() < 6) segment_ms += stage.duration_ms();
    if (stages.size() > 7) register_ms += stage.duration_ms();
    stages.push_back(stage.stage());
  }
  EXPECT_NEAR(answer.timings().segment_ms(), segment_ms, 1e-6);
  EXPECT_NEAR(answer.timings().register_ms(), register_ms, 1e-6);
  EXPECT_THAT(stages, ElementsAre("region", "plane", "outliers", "voxels", "clusters", "normals",
                                  "descriptor", "match", "register", "frame", "verify", "propose"));
}

TEST_F(RecognizeTest, ASegmentedCloudNeedsNoTable) {
  Declare("wedge");
  v1::UploadViewsRequest view = ViewOf("wedge", 0, "a");
  *view.mutable_view()->mutable_cloud() = SegmentedCloudOf("wedge", {}, 7);
  view.mutable_view()->set_segmented(true);
  ASSERT_THAT(Upload(view), IsGrpcOk());
  v1::RecognizeRequest request;
  *request.mutable_cloud() = SegmentedCloudOf("wedge", {.turn_deg = 3}, 8);
  *request.mutable_sensor_pose() = view.view().sensor_pose();
  request.set_segmented(true);
  const v1::RecognizeResponse answer = Answer(request);
  EXPECT_EQ(answer.status(), v1::OK);
  ASSERT_EQ(answer.detections_size(), 1);
  EXPECT_EQ(answer.detections(0).object(), "objects/wedge");
}

// Without a pose z is the camera's: an object on the other side of the image's centre has not
// turned.
TEST_F(RecognizeTest, SegmentedCloudWithoutAPoseMayBeElsewhereInTheImage) {
  Declare("wedge");
  v1::UploadViewsRequest view = ViewOf("wedge", 0, "a");
  *view.mutable_view()->mutable_cloud() = SegmentedCloudOf("wedge", {.x = -0.02, .y = 0.02}, 7);
  view.mutable_view()->set_segmented(true);
  view.mutable_view()->clear_sensor_pose();
  view.mutable_view()->clear_object_pose();
  ASSERT_THAT(Upload(view), IsGrpcOk());
  v1::RecognizeRequest request;
  *request.mutable_cloud() = SegmentedCloudOf("wedge", {.x = 0.02, .y = -0.02}, 8);
  request.set_segmented(true);
  const v1::RecognizeResponse answer = Answer(request);
  ASSERT_EQ(answer.detections_size(), 1);
  EXPECT_EQ(answer.detections(0).object(), "objects/wedge");
  EXPECT_GT(answer.detections(0).refined_pose().orientation().w(), 0.998);
}

}  // namespace
}  // namespace graspdb::testing
