// The error of a pose against the ground truth.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "graspdb/v1/capture_set.pb.h"
#include "recognition/base/types.h"
#include "recognition/points/point_search.h"

namespace graspdb::client {

// Points on an object's surface, to measure poses with. Object frame, metres.
struct ObjectModel {
  recognition::Points points;
  recognition::PointSearch search;
  double diameter_m = 0;
};

// The models of a capture set's objects that have a mesh, by object id.
using ObjectModels = std::map<std::string, std::shared_ptr<const ObjectModel>>;
absl::StatusOr<ObjectModels> LoadModels(const std::filesystem::path& folder,
                                        const v1::CaptureSet& set);

// ADD-S (Hinterstoisser et al. 2012): the mean distance from each point of the
// model in its true pose to the nearest point of the model in the found pose,
// metres. Both poses T_world_object. Invariant to the object's symmetries.
double AddS(const ObjectModel& model, const recognition::Pose& truth,
            const recognition::Pose& found);

// The angle between the rotations, radians, modulo turns of 2 pi / `symmetry_order`
// about the object's z axis (0: any turn).
double RotationError(const recognition::Pose& truth, const recognition::Pose& found,
                     int symmetry_order);

}  // namespace graspdb::client
