// The BackupRecord as RocksDB stores it with a backup. RocksDB protects the files of a backup by
// checksums, but not this text.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "storage/records.pb.h"

namespace graspdb::storage {

// A CRC-32C of the record, 4 bytes, little-endian, and the record.
std::string EncodeBackupRecord(const BackupRecord& record);

// DATA_LOSS if the bytes are damaged or of another program.
absl::StatusOr<BackupRecord> DecodeBackupRecord(std::string_view bytes);

}  // namespace graspdb::storage
