// Records of the storage become what the recognition knows of them.
#pragma once

#include <memory>

#include "absl/status/statusor.h"
#include "recognition/base/types.h"
#include "recognition/descriptors/descriptor_parameters.h"
#include "recognition/index/descriptor_index.h"
#include "recognition/models/taught.h"
#include "storage/records.pb.h"

namespace graspdb::server {

// A view of that resource name, whose parents' names follow from it; the rest is to be filled in.
// INVALID_ARGUMENT for another kind of name.
absl::StatusOr<std::shared_ptr<recognition::TaughtView>> NewTaughtView(const std::string& name);

// DATA_LOSS for a record that this program cannot have written.
absl::StatusOr<std::shared_ptr<const recognition::TaughtView>> ViewFromRecord(
    const storage::ViewRecord& record);

// The descriptor that was made with `parameters`; null when there is none.
const storage::DescriptorRecord* FindDescriptor(
    const storage::ViewRecord& record, const recognition::DescriptorParameters& parameters);

// A view with the descriptor that was made with `parameters`. DATA_LOSS as ViewFromRecord, INTERNAL
// where it has none.
absl::StatusOr<recognition::IndexedView> IndexedViewFromRecord(
    const storage::ViewRecord& record, const recognition::DescriptorParameters& parameters);

// A view's packed cloud as it is matched: voxels and normals in the world frame
// of its capture.
absl::StatusOr<recognition::OrientedCloud> CloudFromPacked(
    std::string_view packed, const recognition::Pose& world_sensor,
    const recognition::DescriptorParameters& parameters);

// Points of a packed cloud, sensor frame.
absl::StatusOr<recognition::Points> PointsFromPacked(std::string_view packed);

// Describes a prepared cloud seen from `world_sensor`.
absl::StatusOr<storage::DescriptorRecord> MakeDescriptorRecord(
    const recognition::OrientedCloud& cloud, const recognition::Pose& world_sensor,
    const recognition::DescriptorParameters& parameters);

}  // namespace graspdb::server
