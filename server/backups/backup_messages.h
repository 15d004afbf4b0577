// Conversion of backups to messages.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "graspdb/v1/backup.pb.h"
#include "storage/backups/backups.h"

namespace graspdb::server {

// Of "backups/7". INVALID_ARGUMENT with the field `path` if it is no such name.
absl::StatusOr<storage::BackupId> ParseBackupName(std::string_view name, std::string_view path);

v1::Backup BackupToProto(const storage::Backup& backup);
v1::BackupDifference DifferenceToProto(const storage::Difference& difference);

}  // namespace graspdb::server
