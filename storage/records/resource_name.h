// Resource names after AIP-122: parsing, checking and making them.
//
//   objects/{object}
//   objects/{object}/stablePoses/{stable_pose}
//   objects/{object}/stablePoses/{stable_pose}/views/{view}
//   cells/{cell}
//   uploads/{upload}
//
// An id has 1 to 63 characters of [A-Za-z0-9_.-] and begins with a letter or a
// digit. Pure functions; safe from any thread.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace graspdb::storage {

struct ObjectName {
  std::string object_id;
};

struct StablePoseName {
  std::string object_id;
  std::string stable_pose_id;
};

struct ViewName {
  std::string object_id;
  std::string stable_pose_id;
  std::string view_id;
};

// INVALID_ARGUMENT, with a sentence that quotes the id and the rule, unless `id` is valid.
absl::Status ValidateResourceId(std::string_view id);

// The parts of a name. INVALID_ARGUMENT, with a sentence that quotes the name and
// the expected form, when it is not one.
absl::StatusOr<ObjectName> ParseObjectName(std::string_view name);
absl::StatusOr<StablePoseName> ParseStablePoseName(std::string_view name);
absl::StatusOr<ViewName> ParseViewName(std::string_view name);
// The same error, unless `name` is one of a cell, or of an upload.
absl::Status CheckCellName(std::string_view name);
absl::Status CheckUploadName(std::string_view name);

// Makes a name from ids. The ids are not checked; the catalogue checks the name.
std::string MakeObjectName(std::string_view object_id);
std::string MakeStablePoseName(std::string_view object_id, std::string_view stable_pose_id);
std::string MakeViewName(std::string_view object_id, std::string_view stable_pose_id,
                         std::string_view view_id);
std::string MakeCellName(std::string_view cell_id);
std::string MakeUploadName(std::string_view upload_id);

}  // namespace graspdb::storage
