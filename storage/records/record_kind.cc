#include "storage/records/record_kind.h"

#include "base/status_macros.h"
#include "storage/base/restore_advice.h"
#include "storage/records/resource_name.h"

namespace graspdb::storage {

absl::StatusOr<Parent> Kind<v1::Object>::ParentOf(std::string_view name) {
  RETURN_IF_ERROR(ParseObjectName(name).status());
  return Parent{};
}

absl::StatusOr<Parent> Kind<DeletedObjectRecord>::ParentOf(std::string_view name) {
  return Kind<v1::Object>::ParentOf(name);
}

absl::StatusOr<Parent> Kind<v1::StablePose>::ParentOf(std::string_view name) {
  ASSIGN_OR_RETURN(const auto parsed, ParseStablePoseName(name));
  return Parent{Family::kObjects, MakeObjectName(parsed.object_id)};
}

absl::StatusOr<Parent> Kind<ViewRecord>::ParentOf(std::string_view name) {
  ASSIGN_OR_RETURN(const auto parsed, ParseViewName(name));
  return Parent{Family::kStablePoses, MakeStablePoseName(parsed.object_id, parsed.stable_pose_id)};
}

absl::StatusOr<Parent> Kind<GraspOutcomesRecord>::ParentOf(std::string_view name) {
  RETURN_IF_ERROR(ParseStablePoseName(name).status());
  return Parent{Family::kStablePoses, std::string(name)};
}

absl::StatusOr<Parent> Kind<v1::Cell>::ParentOf(std::string_view name) {
  RETURN_IF_ERROR(CheckCellName(name));
  return Parent{};
}

absl::StatusOr<Parent> Kind<UploadRecord>::ParentOf(std::string_view name) {
  RETURN_IF_ERROR(CheckUploadName(name));
  return Parent{};
}

absl::Status NotFound(std::string_view word, std::string_view name, std::string_view advice) {
  return absl::NotFoundError("there is no " + std::string(word) + " " + std::string(name) + "; " +
                             std::string(advice));
}

absl::Status AlreadyExists(std::string_view word, std::string_view name) {
  return absl::AlreadyExistsError("the " + std::string(word) + " " + std::string(name) +
                                  " exists already; update it or choose another id");
}

absl::Status DamagedRecord(std::string_view name) {
  return absl::DataLossError("the record of " + std::string(name) + " is damaged; " +
                             std::string(kRestoreAdvice));
}

absl::Status CheckParent(const Database& database, const Parent& parent) {
  if (parent.family == Family::kMeta) return absl::OkStatus();
  ASSIGN_OR_RETURN(const auto there, database.Contains(parent.family, parent.name));
  if (there) return absl::OkStatus();
  const bool is_object = parent.family == Family::kObjects;
  return is_object ? NotFound<v1::Object>(parent.name) : NotFound<v1::StablePose>(parent.name);
}

}  // namespace graspdb::storage
