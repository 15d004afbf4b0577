// Updates the outcomes of grasps when their stable pose changes. Internal to storage/.
#pragma once

#include <string_view>

#include "absl/status/status.h"
#include "graspdb/v1/catalog.pb.h"
#include "storage/changes/change_batch.h"
#include "storage/database/database.h"

namespace graspdb::storage {

// Removes the counts of grasps that were removed or whose geometry changed, within the current
// change. Priority and the distances of approach and retreat do not count as geometry.
absl::Status ForgetChangedGrasps(const Database& database, ChangeBatch& batch,
                                 const v1::StablePose& before, const v1::StablePose& after);

// Removes all counts of a stable pose, if any, within the current change.
absl::Status RemoveGraspOutcomes(const Database& database, ChangeBatch& batch,
                                 std::string_view stable_pose_name);

}  // namespace graspdb::storage
