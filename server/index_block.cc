#include "server/index_block.h"

#include <Eigen/Core>
#include <memory>

#include "server/records.h"

namespace graspdb::server {
namespace {

using recognition::Pose;
using Rows = Eigen::Matrix<double, 3, 4>;

constexpr int kPoseNumbers = 12;

void AddPose(const Pose& pose, storage::IndexBlock* block) {
  const Rows rows = pose.matrix().topRows<3>();
  block->mutable_poses()->Add(rows.data(), rows.data() + kPoseNumbers);
}

Pose PoseAt(const double* numbers) {
  Pose pose = Pose::Identity();
  pose.matrix().topRows<3>() = Eigen::Map<const Rows>(numbers);
  return pose;
}

}  // namespace

storage::IndexBlock BlockFromChunk(const recognition::DescriptorChunk& chunk) {
  storage::IndexBlock block;
  for (std::size_t i = 0; i < chunk.size(); ++i) {
    const recognition::TaughtView& view = *chunk.views()[i];
    block.add_names(view.name);
    block.add_content_digests(view.content);
    AddPose(view.world_object, &block);
    AddPose(view.world_sensor, &block);
    block.add_object_poses_given(view.shares_frame);
    const recognition::Descriptor bins = chunk.DescriptorOf(i);
    block.mutable_bins()->Add(bins.begin(), bins.end());
  }
  return block;
}

absl::StatusOr<std::vector<recognition::IndexedView>> ViewsFromBlock(
    const storage::IndexBlock& block, int size) {
  const int count = block.names_size();
  if (block.content_digests_size() != count || block.poses_size() != 2 * kPoseNumbers * count ||
      block.object_poses_given_size() != count || block.bins_size() != size * count) {
    return absl::DataLossError("a block of the index file has fields of different lengths");
  }
  std::vector<recognition::IndexedView> out;
  out.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    auto view = NewTaughtView(block.names(i));
    if (!view.ok()) return view.status();
    (*view)->content = block.content_digests(i);
    const double* poses = block.poses().data() + std::ptrdiff_t{2} * kPoseNumbers * i;
    (*view)->world_object = PoseAt(poses);
    (*view)->world_sensor = PoseAt(poses + kPoseNumbers);
    (*view)->shares_frame = block.object_poses_given(i);
    const float* bins = block.bins().data() + std::ptrdiff_t{size} * i;
    out.push_back({*std::move(view), {bins, bins + size}});
  }
  return out;
}

}  // namespace graspdb::server
