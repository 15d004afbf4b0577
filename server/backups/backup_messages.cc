#include "server/backups/backup_messages.h"

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "server/base/errors.h"

namespace graspdb::server {
namespace {

constexpr std::string_view kBackupPrefix = "backups/";

v1::BackupDifference::Kind KindToProto(storage::Difference::Kind kind) {
  switch (kind) {
    case storage::Difference::Kind::kAdded:
      return v1::BackupDifference::KIND_ADDED;
    case storage::Difference::Kind::kChanged:
      return v1::BackupDifference::KIND_CHANGED;
    case storage::Difference::Kind::kRemoved:
      return v1::BackupDifference::KIND_REMOVED;
  }
  return v1::BackupDifference::KIND_UNSPECIFIED;
}

std::string BackupName(storage::BackupId id) {
  return absl::StrCat(std::string(kBackupPrefix), id);
}

}  // namespace

absl::StatusOr<storage::BackupId> ParseBackupName(std::string_view name, std::string_view path) {
  storage::BackupId id = 0;
  if (name.starts_with(kBackupPrefix) &&
      absl::SimpleAtoi(std::string(name.substr(kBackupPrefix.size())), &id) && id > 0 &&
      BackupName(id) == name) {
    return id;
  }
  return InvalidField(path, "is not the name of a backup, such as backups/7; list them first");
}

v1::Backup BackupToProto(const storage::Backup& backup) {
  v1::Backup out;
  out.set_name(BackupName(backup.id));
  out.set_damage(BoundedText(std::string(backup.state.message()), kMaxMessageBytes));
  if (!backup.state.ok()) return out;
  const storage::MetaRecord& meta = backup.record.meta();
  *out.mutable_create_time() = backup.record.time();
  out.set_catalog_revision(meta.revision());
  out.set_schema_version(meta.schema_version());
  out.set_object_count(meta.object_count());
  out.set_stable_pose_count(meta.stable_pose_count());
  out.set_view_count(meta.view_count());
  out.set_byte_count(backup.byte_count);
  return out;
}

v1::BackupDifference DifferenceToProto(const storage::Difference& difference) {
  v1::BackupDifference out;
  out.set_kind(KindToProto(difference.kind));
  out.set_name(difference.name);
  return out;
}

}  // namespace graspdb::server
