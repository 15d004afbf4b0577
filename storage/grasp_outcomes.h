// What happens to the outcomes of grasps when their stable pose changes. Internal to storage/.
#pragma once

#include <string_view>

#include "absl/status/status.h"
#include "graspdb/v1/catalog.pb.h"
#include "storage/change_batch.h"
#include "storage/database.h"

namespace graspdb::storage {

// Takes away the counts of grasps that are gone or that are other grasps now, within the change
// that has begun. Priority and the distances of approach and retreat make no other grasp of one.
absl::Status ForgetChangedGrasps(const Database& database, ChangeBatch& batch,
                                 const v1::StablePose& before, const v1::StablePose& after);

// Takes away all counts of a stable pose, if there are any, within the change that has begun.
absl::Status RemoveGraspOutcomes(const Database& database, ChangeBatch& batch,
                                 std::string_view stable_pose_name);

}  // namespace graspdb::storage
