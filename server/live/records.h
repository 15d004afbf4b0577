// Converts records of the storage to the recognition's types.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "recognition/base/types.h"
#include "recognition/descriptors/descriptor.h"
#include "recognition/index/descriptor_index.h"
#include "recognition/models/taught.h"
#include "storage/records.pb.h"
#include "storage/records/packed_cloud.h"

namespace graspdb::server {

// DATA_LOSS for an invalid record.
absl::StatusOr<std::shared_ptr<const recognition::TaughtView>> ViewFromRecord(
    const storage::ViewRecord& record);

// The descriptor with `parameters`; null if there is none.
const storage::DescriptorRecord* FindDescriptor(
    const storage::ViewRecord& record, const recognition::DescriptorParameters& parameters);

// The descriptor of a view that cannot be described with `parameters`: it has no bins. And whether
// a view has it.
storage::DescriptorRecord NoDescriptor(const recognition::DescriptorParameters& parameters);
bool IsUndescribable(const storage::ViewRecord& record,
                     const recognition::DescriptorParameters& parameters);

// A view with its descriptor of `parameters`. DATA_LOSS as ViewFromRecord, INTERNAL if it has none.
absl::StatusOr<recognition::IndexedView> IndexedViewFromRecord(
    const storage::ViewRecord& record, const recognition::DescriptorParameters& parameters);

// A view's packed cloud prepared for matching: voxels and normals in the world frame
// of its capture. The unpacked cloud is freed before the voxels are made.
absl::StatusOr<recognition::OrientedCloud> CloudFromPacked(
    std::string_view packed, const recognition::Pose& world_sensor,
    const recognition::DescriptorParameters& parameters);

// The same of a cloud that is unpacked already; move it in, so that it is freed too.
recognition::OrientedCloud CloudFromUnpacked(std::vector<storage::CloudPoint> unpacked,
                                             const recognition::Pose& world_sensor,
                                             const recognition::DescriptorParameters& parameters);

// Points of a packed cloud, sensor frame.
absl::StatusOr<recognition::Points> PointsFromPacked(std::string_view packed);

// Describes a prepared cloud seen from `world_sensor`.
absl::StatusOr<storage::DescriptorRecord> MakeDescriptorRecord(
    const recognition::OrientedCloud& cloud, const recognition::Pose& world_sensor,
    const recognition::DescriptorParameters& parameters);

}  // namespace graspdb::server
