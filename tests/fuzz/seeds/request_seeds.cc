#include <cstdint>

#include "graspdb/v1/frame_service.pb.h"
#include "tests/fuzz/fuzz_server.h"
#include "tests/fuzz/operations.pb.h"
#include "tests/fuzz/sample_frames.h"
#include "tests/fuzz/seeds/seed_writer.h"

namespace graspdb::fuzz {
namespace {

using testing::Frame;
using testing::Photograph;

v1::RecognizeRequest Posed(const Frame& frame) {
  v1::RecognizeRequest request;
  *request.mutable_sensor_pose() = testing::PoseMessage(frame.world_sensor);
  return request;
}

v1::RecognizeRequest Segmented(const std::string& part, double turn_deg) {
  v1::RecognizeRequest request = Posed(Photograph(part, {}, 3));
  *request.mutable_cloud() = testing::SegmentedCloudOf(part, {.turn_deg = turn_deg}, 3);
  request.set_segmented(true);
  return request;
}

void WriteRecognize(const SeedWriter& out) {
  out.Write("recognize", "segmented", Segmented(kFusedPart, 20).SerializeAsString());
  out.Write("recognize", "loose", Segmented(kLoosePart, 20).SerializeAsString());
  out.Write("recognize", "unknown", Segmented("hex-nut", 0).SerializeAsString());
  const Frame frame = Window(Photograph(kFusedPart, {.turn_deg = 70}, 5), 112, 96);
  v1::RecognizeRequest image = Posed(frame);
  *image.mutable_depth_image() = testing::DepthImageOf(frame);
  *image.mutable_region_of_interest() = testing::BoxMessage({-0.2, -0.2, -0.1}, {0.2, 0.2, 0.3});
  image.set_cell("cells/a");
  out.Write("recognize", "depth-image", image.SerializeAsString());
  const Frame small = Window(Photograph(kLoosePart, {}, 6), 64, 56);
  v1::RecognizeRequest cloud;
  *cloud.mutable_cloud() = testing::CloudOf(small);
  cloud.mutable_pipeline()->set_min_score(0);
  cloud.mutable_pipeline()->set_cluster_tolerance_m(0.01);
  out.Write("recognize", "cloud-without-pose", cloud.SerializeAsString());
}

v1::UploadViewsRequest ViewOf(const std::string& parent, const std::string& id, bool with_pose) {
  v1::UploadViewsRequest view = SegmentedView("hex-nut", 10, id, with_pose);
  view.set_parent(parent);
  return view;
}

Frame WholeFrame() { return Window(Photograph("hex-nut", {}, 5), 48, 44); }

// The view of the whole frame, still without its scan.
v1::UploadViewsRequest WholeViewOf(const std::string& parent, const std::string& id) {
  v1::UploadViewsRequest request;
  request.set_parent(parent);
  request.set_view_id(id);
  *request.mutable_view()->mutable_sensor_pose() = testing::PoseMessage(WholeFrame().world_sensor);
  *request.mutable_region_of_interest() = testing::BoxMessage({-0.1, -0.1, -0.1}, {0.1, 0.1, 0.2});
  return request;
}

v1::UploadViewsRequest ImageViewOf(const std::string& parent, const std::string& id) {
  v1::UploadViewsRequest request = WholeViewOf(parent, id);
  *request.mutable_view()->mutable_depth_image() = testing::DepthImageOf(WholeFrame());
  return request;
}

void WriteUploads(const SeedWriter& out) {
  constexpr char kParent[] = "objects/fuzzed/stablePoses/flat";
  for (const bool with_pose : {false, true}) {
    Uploads uploads;
    *uploads.add_views() = ViewOf(kParent, "a", with_pose);
    *uploads.add_views() = ViewOf(kParent, "b", with_pose);
    out.Write("upload_views", with_pose ? "posed" : "loose", uploads.SerializeAsString());
  }
  Uploads whole;
  v1::UploadViewsRequest& view = *whole.add_views();
  view = WholeViewOf(kParent, "c");
  *view.mutable_view()->mutable_cloud() = testing::CloudOf(WholeFrame());
  out.Write("upload_views", "whole", whole.SerializeAsString());
  Uploads image;
  *image.add_views() = ImageViewOf(kParent, "d");
  out.Write("upload_views", "depth-image", image.SerializeAsString());
}

// Makes the objects "a" and "b" with a stable pose each.
Operations Declared() {
  Operations out;
  for (const char* id : {"a", "b"}) {
    v1::CreateObjectRequest& object = *out.add_operations()->mutable_create_object();
    object.set_object_id(id);
    object.mutable_object()->set_display_name("The first");
    object.mutable_object()->add_labels("x");
    v1::CreateStablePoseRequest& pose = *out.add_operations()->mutable_create_stable_pose();
    pose.set_parent(std::string("objects/") + id);
    pose.set_stable_pose_id("flat");
    v1::Grasp& grasp = *pose.mutable_stable_pose()->add_grasps();
    grasp.set_grasp_id("top");
    grasp.mutable_tcp_pose()->mutable_orientation()->set_w(1);
    pose.mutable_stable_pose()->set_symmetry_order(1);
  }
  return out;
}

Operations Changed() {
  Operations out = Declared();
  v1::UpdateObjectRequest& object = *out.add_operations()->mutable_update_object();
  object.mutable_object()->set_name("objects/a");
  object.mutable_object()->set_display_name("another");
  object.mutable_update_mask()->add_paths("display_name");
  v1::UpdateStablePoseRequest& pose = *out.add_operations()->mutable_update_stable_pose();
  pose.mutable_stable_pose()->set_name("objects/a/stablePoses/flat");
  pose.mutable_stable_pose()->set_min_score(0.5);
  pose.mutable_update_mask()->add_paths("min_score");
  v1::ReportGraspOutcomeRequest& outcome = *out.add_operations()->mutable_report_grasp_outcome();
  outcome.set_name("objects/a/stablePoses/flat");
  outcome.set_grasp_id("top");
  outcome.set_outcome(v1::GRASP_OUTCOME_PICKED);
  outcome.set_request_id("123e4567-e89b-42d3-a456-426614174000");
  out.add_operations()->mutable_list_objects()->set_page_size(1);
  out.add_operations()->mutable_list_stable_poses()->set_parent("objects/a");
  out.add_operations()->mutable_get_stable_pose()->set_name("objects/a/stablePoses/flat");
  out.add_operations()->mutable_delete_stable_pose()->set_name("objects/b/stablePoses/flat");
  out.add_operations()->mutable_delete_object()->set_name("objects/b");
  return out;
}

Operations TaughtInBulk() {
  Operations out = Declared();
  out.add_operations()->mutable_create_upload()->set_upload_id("a");
  BulkViews& views = *out.add_operations()->mutable_write_upload_views();
  for (const char* id : {"v", "w"}) {
    v1::WriteUploadViewsRequest& view = *views.add_views();
    view.set_upload("uploads/a");
    *view.mutable_view() = ViewOf("objects/a/stablePoses/flat", id, true);
  }
  out.add_operations()->mutable_get_upload()->set_name("uploads/a");
  out.add_operations()->mutable_list_upload_views()->set_parent("uploads/a");
  v1::CommitUploadRequest& commit = *out.add_operations()->mutable_commit_upload();
  commit.set_name("uploads/a");
  commit.set_skip_failed(true);
  out.add_operations()->mutable_list_uploads();
  out.add_operations()->mutable_delete_upload()->set_name("uploads/a");
  return out;
}

Operations Taught() {
  Operations out = Declared();
  Uploads& uploads = *out.add_operations()->mutable_upload_views();
  *uploads.add_views() = ViewOf("objects/a/stablePoses/flat", "v", true);
  *uploads.add_views() = ViewOf("objects/b/stablePoses/flat", "v", false);
  *uploads.add_views() = ImageViewOf("objects/b/stablePoses/flat", "w");
  out.add_operations()->mutable_list_views()->set_parent("objects/a/stablePoses/flat");
  out.add_operations()->mutable_get_view()->set_name("objects/a/stablePoses/flat/views/v");
  *out.add_operations()->mutable_recognize() = Segmented("hex-nut", 30);
  auto& frame = *out.add_operations()->mutable_recognize_stream()->add_frames();
  frame.set_frame_id("1");
  *frame.mutable_request() = Segmented("hex-nut", 50);
  out.add_operations()->mutable_find_look_alikes();
  out.add_operations()->mutable_propose_thresholds()->set_object("objects/a");
  out.add_operations()->mutable_delete_view()->set_name("objects/b/stablePoses/flat/views/v");
  return out;
}

Operations Cells() {
  Operations out;
  v1::CreateCellRequest& made = *out.add_operations()->mutable_create_cell();
  made.set_cell_id("a");
  v1::Cell& cell = *made.mutable_cell();
  cell.mutable_sensor_pose()->mutable_orientation()->set_w(1);
  *cell.mutable_workspace() = testing::BoxMessage({-1, -1, 0}, {1, 1, 1});
  cell.mutable_pipeline()->set_min_score(0.4);
  v1::UpdateCellRequest& update = *out.add_operations()->mutable_update_cell();
  update.mutable_cell()->set_name("cells/a");
  update.mutable_cell()->mutable_pipeline()->set_icp_iteration_count(5);
  update.mutable_update_mask()->add_paths("pipeline");
  out.add_operations()->mutable_get_cell()->set_name("cells/a");
  out.add_operations()->mutable_list_cells();
  v1::RecognizeRequest& frame = *out.add_operations()->mutable_recognize();
  frame = Segmented("hex-nut", 0);
  frame.clear_sensor_pose();
  frame.set_cell("cells/a");
  out.add_operations()->mutable_delete_cell()->set_name("cells/a");
  return out;
}

// The frames of WriteRecognize.
void WritePushedFrames(const SeedWriter& out) {
  constexpr std::int64_t kCaptured = 1'700'000'000;
  v1::PushFrameRequest image;
  image.set_camera("left");
  *image.mutable_depth_image() =
      testing::DepthImageOf(Window(Photograph(kFusedPart, {.turn_deg = 70}, 5), 112, 96));
  image.mutable_depth_image()->mutable_capture_time()->set_seconds(kCaptured);
  out.Write("push_frame", "depth-image", image.SerializeAsString());
  v1::PushFrameRequest cloud;
  cloud.set_camera("left");
  *cloud.mutable_cloud() = testing::CloudOf(Window(Photograph(kLoosePart, {}, 6), 64, 56));
  cloud.mutable_cloud()->mutable_capture_time()->set_seconds(kCaptured);
  out.Write("push_frame", "cloud", cloud.SerializeAsString());
}

}  // namespace

void WriteRequestSeeds(const SeedWriter& out) {
  WriteRecognize(out);
  WriteUploads(out);
  WritePushedFrames(out);
  out.Write("catalogue", "changed", Changed().SerializeAsString());
  out.Write("catalogue", "taught", Taught().SerializeAsString());
  out.Write("catalogue", "taught_in_bulk", TaughtInBulk().SerializeAsString());
  out.Write("catalogue", "cells", Cells().SerializeAsString());
}

}  // namespace graspdb::fuzz
