#include "tests/fuzz/sample_frames.h"

namespace graspdb::fuzz {

testing::Frame Window(const testing::Frame& frame, int width, int height) {
  const int left = (frame.camera.width - width) / 2;
  const int top = (frame.camera.height - height) / 2;
  testing::Frame out = frame;
  out.camera.width = width;
  out.camera.height = height;
  out.camera.cx -= left;
  out.camera.cy -= top;
  out.counts.clear();
  for (int v = top; v < top + height; ++v) {
    const auto row = frame.counts.begin() + std::ptrdiff_t{v} * frame.camera.width + left;
    out.counts.insert(out.counts.end(), row, row + width);
  }
  return out;
}

v1::UploadViewsRequest SegmentedView(const std::string& part, double turn_deg,
                                     const std::string& id, bool with_object_pose) {
  const testing::Stand stand{.turn_deg = turn_deg};
  const testing::Frame frame = testing::Photograph(part, stand, 7);
  v1::UploadViewsRequest request;
  request.set_parent("objects/" + part + "/stablePoses/flat");
  request.set_view_id(id);
  *request.mutable_view()->mutable_cloud() = testing::SegmentedCloudOf(part, stand, 7);
  request.mutable_view()->set_segmented(true);
  *request.mutable_view()->mutable_sensor_pose() = testing::PoseMessage(frame.world_sensor);
  if (with_object_pose) {
    *request.mutable_view()->mutable_object_pose() = testing::PoseMessage(frame.world_object);
  }
  return request;
}

}  // namespace graspdb::fuzz
