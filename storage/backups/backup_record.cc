#include "storage/backups/backup_record.h"

#include "absl/status/status.h"
#include "storage/base/crc32c.h"
#include "storage/base/little_endian.h"

namespace graspdb::storage {

std::string EncodeBackupRecord(const BackupRecord& record) {
  const std::string bytes = record.SerializeAsString();
  return ToLittleEndian(Crc32c(bytes)) + bytes;
}

absl::StatusOr<BackupRecord> DecodeBackupRecord(std::string_view bytes) {
  BackupRecord record;
  if (bytes.size() > kUint32Bytes) {
    const std::string_view content = bytes.substr(kUint32Bytes);
    if (FromLittleEndian(bytes.substr(0, kUint32Bytes)) == Crc32c(content) &&
        record.ParseFromArray(content.data(), static_cast<int>(content.size()))) {
      return record;
    }
  }
  return absl::DataLossError("its record is damaged, or of another program");
}

}  // namespace graspdb::storage
