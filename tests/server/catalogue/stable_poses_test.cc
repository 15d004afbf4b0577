// Stable poses and the reading of views through the CatalogService.
#include <gmock/gmock.h>

#include <limits>
#include <numeric>

#include "recognition/descriptors/descriptor.h"
#include "tests/server/server_fixture.h"

namespace graspdb::testing {
namespace {

using ::testing::ElementsAre;

class StablePosesTest : public ServerTest {
 protected:
  grpc::Status Create(const std::string& parent, const std::string& id, v1::StablePose* made) {
    v1::CreateStablePoseRequest request;
    request.set_parent(parent);
    request.set_stable_pose_id(id);
    request.mutable_stable_pose()->set_display_name("upright");
    return Call(&Catalog::CreateStablePose, request, made);
  }

  grpc::Status Get(const std::string& name, v1::StablePose* pose) {
    v1::GetStablePoseRequest request;
    request.set_name(name);
    return Call(&Catalog::GetStablePose, request, pose);
  }

  grpc::Status Update(const v1::StablePose& pose, const std::vector<std::string>& mask,
                      v1::StablePose* updated) {
    v1::UpdateStablePoseRequest request;
    *request.mutable_stable_pose() = pose;
    for (const std::string& path : mask) request.mutable_update_mask()->add_paths(path);
    return Call(&Catalog::UpdateStablePose, request, updated);
  }

  grpc::Status Delete(const std::string& name, bool force, const std::string& etag = "") {
    v1::DeleteStablePoseRequest request;
    request.set_name(name);
    request.set_force(force);
    request.set_etag(etag);
    return Call(&Catalog::DeleteStablePose, request);
  }

  grpc::Status GetView(const std::string& name, v1::ViewDetail detail, v1::View* view) {
    v1::GetViewRequest request;
    request.set_name(name);
    request.set_detail(detail);
    return Call(&Catalog::GetView, request, view);
  }

  grpc::Status ListViews(int page_size, const std::string& token, v1::ListViewsResponse* page) {
    v1::ListViewsRequest request;
    request.set_parent(FlatPoseOf("wedge"));
    request.set_page_size(page_size);
    request.set_page_token(token);
    page->Clear();
    return Call(&Catalog::ListViews, request, page);
  }
};

TEST_F(StablePosesTest, ACreatedStablePoseIsReadBackAndListed) {
  ASSERT_THAT(CreateObject("mug"), IsGrpcOk());
  v1::StablePose made;
  ASSERT_THAT(Create("objects/mug", "upright", &made), IsGrpcOk());
  EXPECT_EQ(made.name(), "objects/mug/stablePoses/upright");
  v1::StablePose read;
  ASSERT_THAT(Get(made.name(), &read), IsGrpcOk());
  EXPECT_EQ(read.SerializeAsString(), made.SerializeAsString());
  v1::ListStablePosesRequest request;
  request.set_parent("objects/mug");
  v1::ListStablePosesResponse page;
  ASSERT_THAT(Call(&Catalog::ListStablePoses, request, &page), IsGrpcOk());
  ASSERT_EQ(page.stable_poses_size(), 1);
  EXPECT_EQ(page.stable_poses(0).name(), made.name());
}

TEST_F(StablePosesTest, ParentsMustExist) {
  v1::StablePose pose;
  ExpectError(Create("objects/mug", "upright", &pose), grpc::StatusCode::NOT_FOUND, "objects/mug");
  v1::ListStablePosesRequest request;
  request.set_parent("objects/mug");
  ExpectError(Call(&Catalog::ListStablePoses, request), grpc::StatusCode::NOT_FOUND, "objects/mug");
  v1::ListViewsResponse page;
  ExpectError(ListViews(0, "", &page), grpc::StatusCode::NOT_FOUND, FlatPoseOf("wedge"));
}

TEST_F(StablePosesTest, ATakenIdIsAnError) {
  ASSERT_THAT(CreateObject("mug"), IsGrpcOk());
  v1::StablePose pose;
  ASSERT_THAT(Create("objects/mug", "upright", &pose), IsGrpcOk());
  ExpectError(Create("objects/mug", "upright", &pose), grpc::StatusCode::ALREADY_EXISTS,
              "objects/mug/stablePoses/upright");
}

TEST_F(StablePosesTest, MaskedUpdateOfTheGraspsKeepsOtherFields) {
  Declare("wedge");
  v1::StablePose pose;
  ASSERT_THAT(Get(FlatPoseOf("wedge"), &pose), IsGrpcOk());
  v1::StablePose change;
  change.set_name(pose.name());
  change.set_symmetry_order(6);
  *change.add_grasps() = pose.grasps(0);
  change.mutable_grasps(0)->set_grasp_id("only");
  v1::StablePose updated;
  ASSERT_THAT(Update(change, {"grasps"}, &updated), IsGrpcOk());
  EXPECT_EQ(updated.symmetry_order(), pose.symmetry_order());
  ASSERT_EQ(updated.grasps_size(), 1);
  EXPECT_EQ(updated.grasps(0).grasp_id(), "only");
}

TEST_F(StablePosesTest, RejectedUpdateChangesNothing) {
  Declare("wedge");
  v1::StablePose before;
  ASSERT_THAT(Get(FlatPoseOf("wedge"), &before), IsGrpcOk());
  v1::StablePose change = before;
  change.set_display_name("new");
  change.set_symmetry_order(-1);
  v1::StablePose after;
  ExpectBadField(Update(change, {}, &after), "stable_pose.symmetry_order", "0 (any turn) to 360");
  ASSERT_THAT(Get(before.name(), &after), IsGrpcOk());
  EXPECT_EQ(after.SerializeAsString(), before.SerializeAsString());
}

TEST_F(StablePosesTest, MinimumScoreOutOfRangeIsRejected) {
  Declare("wedge");
  v1::StablePose change;
  change.set_name(FlatPoseOf("wedge"));
  change.set_min_score(1.5);
  v1::StablePose after;
  ExpectBadField(Update(change, {"min_score"}, &after), "stable_pose.min_score", "0 to 1");
}

TEST_F(StablePosesTest, AMaskedFieldWithoutAValueIsCleared) {
  Declare("wedge");
  v1::StablePose change;
  change.set_name(FlatPoseOf("wedge"));
  change.set_min_score(0.3);
  v1::StablePose after;
  ASSERT_THAT(Update(change, {"min_score"}, &after), IsGrpcOk());
  EXPECT_EQ(after.min_score(), 0.3);
  change.clear_min_score();
  ASSERT_THAT(Update(change, {"min_score"}, &after), IsGrpcOk());
  EXPECT_FALSE(after.has_min_score());
}

v1::Pose MeshPose() {
  v1::Pose pose;
  pose.mutable_position()->set_x(-0.05);
  pose.mutable_position()->set_z(0.02);
  pose.mutable_orientation()->set_x(0.6);
  pose.mutable_orientation()->set_w(0.8);
  return pose;
}

TEST_F(StablePosesTest, TheMeshsFrameIsKeptWhenOtherFieldsChangeAndOverARestart) {
  Declare("wedge");
  v1::StablePose change;
  change.set_name(FlatPoseOf("wedge"));
  *change.mutable_mesh_pose() = MeshPose();
  v1::StablePose after;
  ASSERT_THAT(Update(change, {"mesh_pose"}, &after), IsGrpcOk());
  change.clear_mesh_pose();
  change.set_display_name("new");
  ASSERT_THAT(Update(change, {"display_name"}, &after), IsGrpcOk());
  Restart();
  v1::StablePose read;
  ASSERT_THAT(Get(change.name(), &read), IsGrpcOk());
  EXPECT_EQ(read.mesh_pose().SerializeAsString(), MeshPose().SerializeAsString());
  ASSERT_THAT(Update(change, {"mesh_pose"}, &after), IsGrpcOk());
  EXPECT_FALSE(after.has_mesh_pose());
}

TEST_F(StablePosesTest, InvalidMeshFrameIsRejected) {
  Declare("wedge");
  v1::StablePose change;
  change.set_name(FlatPoseOf("wedge"));
  v1::StablePose after;
  *change.mutable_mesh_pose() = MeshPose();
  change.mutable_mesh_pose()->mutable_orientation()->set_w(2);
  ExpectBadField(Update(change, {"mesh_pose"}, &after), "stable_pose.mesh_pose.orientation",
                 "unit quaternion");
  for (const double x : {1001.0, std::numeric_limits<double>::quiet_NaN()}) {
    *change.mutable_mesh_pose() = MeshPose();
    change.mutable_mesh_pose()->mutable_position()->set_x(x);
    ExpectBadField(Update(change, {}, &after), "stable_pose.mesh_pose.position", "1000 m");
  }
  ASSERT_THAT(Get(change.name(), &after), IsGrpcOk());
  EXPECT_FALSE(after.has_mesh_pose());
}

TEST_F(StablePosesTest, AStaleEtagAbortsTheWrite) {
  Declare("wedge");
  v1::StablePose stale;
  ASSERT_THAT(Get(FlatPoseOf("wedge"), &stale), IsGrpcOk());
  v1::StablePose fresh;
  ASSERT_THAT(Update(stale, {"display_name"}, &fresh), IsGrpcOk());
  ExpectError(Update(stale, {"display_name"}, &fresh), grpc::StatusCode::ABORTED, stale.name());
  ExpectError(Delete(stale.name(), false, stale.etag()), grpc::StatusCode::ABORTED, stale.name());
}

TEST_F(StablePosesTest, AStablePoseWithViewsIsDeletedOnlyByForce) {
  Teach("wedge", 2);
  ExpectError(Delete(FlatPoseOf("wedge"), false), grpc::StatusCode::FAILED_PRECONDITION, "force");
  EXPECT_EQ(Status().view_count(), 2);
  ASSERT_THAT(Delete(FlatPoseOf("wedge"), true), IsGrpcOk());
  EXPECT_EQ(Status().view_count(), 0);
  v1::View view;
  ExpectError(GetView(FlatPoseOf("wedge") + "/views/turn-0", v1::VIEW_DETAIL_FULL, &view),
              grpc::StatusCode::NOT_FOUND, "turn-0");
}

TEST_F(StablePosesTest, OnlyAFullViewHasItsCloud) {
  Teach("wedge", 1);
  const std::string name = FlatPoseOf("wedge") + "/views/turn-0";
  v1::View basic;
  ASSERT_THAT(GetView(name, v1::VIEW_DETAIL_UNSPECIFIED, &basic), IsGrpcOk());
  EXPECT_FALSE(basic.has_cloud());
  EXPECT_GT(basic.point_count(), 100);
  v1::View full;
  ASSERT_THAT(GetView(name, v1::VIEW_DETAIL_FULL, &full), IsGrpcOk());
  EXPECT_EQ(static_cast<int>(full.cloud().data().size()),
            full.point_count() * full.cloud().point_stride());
  full.clear_cloud();
  EXPECT_EQ(full.SerializeAsString(), basic.SerializeAsString());
}

TEST_F(StablePosesTest, ADescribedViewHasEachDescriptorOfItsCloud) {
  Teach("wedge", 1);
  const std::string name = FlatPoseOf("wedge") + "/views/turn-0";
  v1::View basic;
  ASSERT_THAT(GetView(name, v1::VIEW_DETAIL_BASIC, &basic), IsGrpcOk());
  EXPECT_THAT(basic.descriptors(), ::testing::IsEmpty());
  v1::View described;
  ASSERT_THAT(GetView(name, v1::VIEW_DETAIL_DESCRIBED, &described), IsGrpcOk());
  std::vector<std::string> names;
  for (const v1::ViewDescriptor& each : described.descriptors()) {
    names.push_back(each.name());
    const auto kind = recognition::DescriptorFromName(each.name());
    ASSERT_TRUE(kind.has_value()) << each.name();
    EXPECT_EQ(each.bins_size(), recognition::DescriptorSize(*kind));
    // Four parts of 100 as PCL scales them; its fifth one, of distances, is empty.
    const double mass = *kind == recognition::DescriptorKind::kVfh308 ? 400 : 1;
    EXPECT_NEAR(std::accumulate(each.bins().begin(), each.bins().end(), 0.0), mass, 0.01 * mass);
  }
  EXPECT_EQ(names, recognition::DescriptorNames());
  described.clear_descriptors();
  EXPECT_EQ(described.SerializeAsString(), basic.SerializeAsString());
}

TEST_F(StablePosesTest, DescriptorsOfAnUploadAreIgnored) {
  Teach("wedge", 1);
  v1::View described;
  ASSERT_THAT(GetView(FlatPoseOf("wedge") + "/views/turn-0", v1::VIEW_DETAIL_DESCRIBED, &described),
              IsGrpcOk());
  v1::UploadViewsRequest upload = ViewOf("wedge", 0, "again");
  *upload.mutable_view()->mutable_descriptors() = described.descriptors();
  for (v1::ViewDescriptor& each : *upload.mutable_view()->mutable_descriptors())
    each.set_bins(0, 7);
  ASSERT_THAT(Upload(upload), IsGrpcOk());
  v1::View again;
  ASSERT_THAT(GetView(FlatPoseOf("wedge") + "/views/again", v1::VIEW_DETAIL_DESCRIBED, &again),
              IsGrpcOk());
  EXPECT_NE(again.descriptors(0).bins(0), 7);
}

TEST_F(StablePosesTest, AViewKeepsThePosesOfItsCapture) {
  Teach("wedge", 1);
  const v1::UploadViewsRequest upload = ViewOf("wedge", 0, "turn-0");
  v1::View view;
  ASSERT_THAT(GetView(FlatPoseOf("wedge") + "/views/turn-0", v1::VIEW_DETAIL_BASIC, &view),
              IsGrpcOk());
  EXPECT_NEAR(view.sensor_pose().position().z(), upload.view().sensor_pose().position().z(), 1e-9);
  EXPECT_NEAR(view.sensor_pose().orientation().x(), upload.view().sensor_pose().orientation().x(),
              1e-9);
  EXPECT_NEAR(view.object_pose().orientation().w(), 1, 1e-9);
}

TEST_F(StablePosesTest, ViewsAreListedInPagesWithoutClouds) {
  Teach("wedge", 3);
  std::vector<std::string> names;
  v1::ListViewsResponse page;
  do {
    ASSERT_THAT(ListViews(2, page.next_page_token(), &page), IsGrpcOk());
    for (const v1::View& view : page.views()) {
      EXPECT_FALSE(view.has_cloud());
      names.push_back(view.name());
    }
  } while (!page.next_page_token().empty());
  const std::string prefix = FlatPoseOf("wedge") + "/views/turn-";
  EXPECT_THAT(names, ElementsAre(prefix + "0", prefix + "1", prefix + "2"));
}

TEST_F(StablePosesTest, DeletedViewIsNotFound) {
  Teach("wedge", 2);
  v1::DeleteViewRequest request;
  request.set_name(FlatPoseOf("wedge") + "/views/turn-1");
  ASSERT_THAT(Call(&Catalog::DeleteView, request), IsGrpcOk());
  ExpectError(Call(&Catalog::DeleteView, request), grpc::StatusCode::NOT_FOUND, "turn-1");
  EXPECT_EQ(Status().view_count(), 1);
}

}  // namespace
}  // namespace graspdb::testing
