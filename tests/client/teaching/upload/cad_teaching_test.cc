// Views of meshes in a real catalogue.
#include <gmock/gmock.h>

#include "client/teaching/mesh/cad_part.h"
#include "client/teaching/upload/cad_views.h"
#include "files/messages/pose_message.h"
#include "files/messages/scan_message.h"
#include "rendering/camera/depth_camera.h"
#include "rendering/meshes/solid.h"
#include "rendering/random/counter_random.h"
#include "rendering/simulation.h"
#include "tests/client/catalogue_server.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using ::graspdb::testing::IsOk;
using recognition::Pose;

class CadTeachingTest : public ::testing::Test {
 protected:
  // The bounds of every view of a box with these half widths and this height, in the object's
  // frame.
  recognition::Box KeptOf(float x, float y, float height) {
    rendering::Workpiece part{.object_id = "box",
                              .display_name = "",
                              .stable_pose_id = "resting-1",
                              .grasps = {},
                              .mesh = rendering::BoxSolid({-x, -y, 0}, {x, y, height})};
    CadViews views;
    views.world_sensor = rendering::LookAt({0, 0, 0.1}, 1.4, 40, -90);
    views.step_deg = 30;
    EXPECT_THAT(TeachCadViews(client_, {part}, views, {}), IsOk());
    recognition::Box common{{-1, -1, -1}, {1, 1, 1}};
    const auto listed = client_.ListViews("objects/box/stablePoses/resting-1");
    EXPECT_THAT(listed, IsOk());
    EXPECT_EQ(listed->size(), 12U);
    for (const v1::View& one : *listed) {
      const auto view = client_.GetView(one.name());
      EXPECT_THAT(view, IsOk());
      const auto points = files::PointsFromMessage(view->cloud());
      EXPECT_THAT(points, IsOk());
      const Pose object_sensor = files::FromMessage(view->object_pose()).inverse() *
                                 files::FromMessage(view->sensor_pose());
      recognition::Box box;
      for (const Eigen::Vector3f& p : *points) {
        const Eigen::Vector3d q = object_sensor * p.cast<double>();
        box.min = box.min.cwiseMin(q);
        box.max = box.max.cwiseMax(q);
      }
      common.min = common.min.cwiseMax(box.min);
      common.max = common.max.cwiseMin(box.max);
    }
    return common;
  }

  graspdb::testing::CatalogueServer server_;
  Client& client_ = server_.client();
};

class MeshFrameTest : public CadTeachingTest {
 protected:
  MeshFrameTest() {
    part_.object_id = "box";
    part_.stable_pose_id = "resting-1";
    part_.mesh = rendering::BoxSolid({-0.04F, -0.03F, 0}, {0.04F, 0.03F, 0.05F});
    part_.object_mesh = Pose::Identity();
    part_.object_mesh->translation() = Eigen::Vector3d(0.1, 0.2, 0.3);
  }

  absl::Status Teach() {
    CadViews views;
    views.world_sensor = rendering::LookAt({0, 0, 0}, 0.8, 40, -90);
    views.step_deg = 120;
    return TeachCadViews(client_, {part_}, views, {}).status();
  }

  v1::StablePose Taught() {
    const auto pose = client_.GetStablePose(kName);
    EXPECT_THAT(pose, IsOk());
    return pose.value_or(v1::StablePose());
  }

  static constexpr char kName[] = "objects/box/stablePoses/resting-1";
  rendering::Workpiece part_;
};

TEST_F(MeshFrameTest, IsTaughtAndFilledInWhereItIsMissing) {
  ASSERT_THAT(Teach(), IsOk());
  EXPECT_EQ(Taught().mesh_pose().position().y(), 0.2);
  v1::UpdateStablePoseRequest older;  // as stored before this field existed
  older.mutable_stable_pose()->set_name(kName);
  older.mutable_update_mask()->add_paths("mesh_pose");
  ASSERT_THAT(client_.UpdateStablePose(older), IsOk());
  ASSERT_FALSE(Taught().has_mesh_pose());
  ASSERT_THAT(Teach(), IsOk());
  EXPECT_EQ(Taught().mesh_pose().position().y(), 0.2);
  const std::string etag = Taught().etag();
  part_.object_mesh->translation().x() += 1e-5;
  ASSERT_THAT(Teach(), IsOk());
  EXPECT_EQ(Taught().etag(), etag);
}

TEST_F(MeshFrameTest, TheFrameOfAnotherMeshIsRejected) {
  ASSERT_THAT(Teach(), IsOk());
  part_.object_mesh->translation().x() += 0.01;
  const absl::Status refused = Teach();
  EXPECT_TRUE(absl::IsFailedPrecondition(refused)) << refused;
  EXPECT_EQ(Taught().mesh_pose().position().x(), 0.1);
}

// The mesh pose maps the vertices to their true positions in the world, and back.
TEST_F(CadTeachingTest, DetectionsHaveTheFrameOfTheMesh) {
  const rendering::TriangleMesh mesh = rendering::ExtrudeAlongY(
      {{0, 0}, {0.1F, 0}, {0.1F, 0.02F}, {0.025F, 0.02F}, {0.025F, 0.08F}, {0, 0.08F}}, 0, 0.04F);
  const auto all = ProposeCadPart("angle", "", mesh, {});
  ASSERT_THAT(all, IsOk());
  const auto part = Select(*all, {1, 3});
  ASSERT_THAT(part, IsOk());
  CadViews views;
  views.world_sensor = rendering::LookAt({0, 0, 0}, 0.8, 40, -90);
  ASSERT_THAT(TeachCadViews(client_, part->workpieces, views, {}), IsOk());
  const auto camera = rendering::DepthCamera::Create(views.camera);
  ASSERT_THAT(camera, IsOk());
  for (std::size_t i = 0; i < part->workpieces.size(); ++i) {
    Pose world_object = Pose::Identity();
    world_object.translation() = Eigen::Vector3d(0.05, -0.03, 0);
    world_object.rotate(Eigen::AngleAxisd(1.2, Eigen::Vector3d::UnitZ()));
    rendering::Scene scene;
    scene.objects.push_back({.mesh = &part->workpieces[i].mesh, .world_object = world_object});
    const auto frame = camera->Render(scene, views.world_sensor, rendering::RandomBits(7, i, 0));
    ASSERT_THAT(frame, IsOk());
    v1::RecognizeRequest request;
    *request.mutable_cloud() =
        files::CloudMessage(rendering::ToPoints(*frame, views.camera.intrinsics), frame->width);
    *request.mutable_sensor_pose() = files::ToMessage(views.world_sensor);
    *request.mutable_region_of_interest() = rendering::SimulatedRegion();
    const auto response = client_.Recognize(request);
    ASSERT_THAT(response, IsOk());
    ASSERT_EQ(response->detections_size(), 1);
    ASSERT_TRUE(response->detections(0).has_mesh_pose()) << response->detections(0).status();
    const Pose world_mesh = files::FromMessage(response->detections(0).mesh_pose());
    const Pose truth = world_object * part->found.poses[i].object_mesh;
    for (const Eigen::Vector3f& vertex : mesh.vertices) {
      const Eigen::Vector3d v = vertex.cast<double>();
      EXPECT_LT((world_mesh * v - truth * v).norm(), 0.006);
      EXPECT_LT((world_mesh.inverse() * (truth * v) - v).norm(), 0.006);
    }
  }
}

// The server's steps of 0.05 mm and the depth image's, which are finer, are the only errors of
// views without noise.
TEST_F(CadTeachingTest, ViewsLieOnTheSurfaceOfTheMesh) {
  const rendering::Workpiece part{
      .object_id = "box",
      .display_name = "",
      .stable_pose_id = "resting-1",
      .grasps = {},
      .mesh = rendering::BoxSolid({-0.05F, -0.04F, 0}, {0.05F, 0.04F, 0.06F})};
  CadViews views;
  views.camera.noise = {};
  views.world_sensor = rendering::LookAt({0, 0, 0}, 0.8, 40, -90);
  views.step_deg = 120;
  ASSERT_THAT(TeachCadViews(client_, {part}, views, {}), IsOk());
  const auto listed = client_.ListViews("objects/box/stablePoses/resting-1");
  ASSERT_THAT(listed, IsOk());
  for (const v1::View& one : *listed) {
    const auto view = client_.GetView(one.name());
    ASSERT_THAT(view, IsOk());
    const auto points = files::PointsFromMessage(view->cloud());
    ASSERT_THAT(points, IsOk());
    EXPECT_GT(points->size(), 500U);
    const Pose object_sensor =
        files::FromMessage(view->object_pose()).inverse() * files::FromMessage(view->sensor_pose());
    for (const Eigen::Vector3f& p : *points) {
      const Eigen::Vector3d q = object_sensor * p.cast<double>();
      const Eigen::Vector3d from_faces(0.05 - std::abs(q.x()), 0.04 - std::abs(q.y()),
                                       0.06 - q.z());
      EXPECT_LT(from_faces.cwiseAbs().minCoeff(), 6e-5) << q.transpose();
    }
  }
}

TEST_F(CadTeachingTest, ATallObjectIsKeptUpToItsTop) {
  EXPECT_GT(KeptOf(0.05F, 0.04F, 0.55F).max.z(), 0.54);
}

TEST_F(CadTeachingTest, ALongObjectIsKeptToItsEndsAtEveryAzimuth) {
  const recognition::Box kept = KeptOf(0.04F, 0.33F, 0.06F);
  EXPECT_GT(kept.max.y(), 0.32);
  EXPECT_LT(kept.min.y(), -0.32);
}

}  // namespace
}  // namespace graspdb::client
