// Bytes of the storage: packed clouds ("GPC"), RocksDB's logs and records of backups (all others).
// Checksums are corrected before an input is read, so that the data after them are parsed.
#include <cstdint>
#include <string>
#include <string_view>

#include "storage/backups/backup_engine.h"
#include "storage/base/crc32c.h"
#include "storage/base/little_endian.h"
#include "storage/database/log_check.h"
#include "storage/records/packed_cloud.h"
#include "tests/fuzz/bytes_target.h"
#include "tests/fuzz/requirement.h"

namespace graspdb::fuzz {
namespace {

void PutUint32(std::uint32_t value, std::size_t at, std::string& bytes) {
  for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<char>(value >> (8 * i));
}

void ReadCloud(std::string bytes) {
  constexpr std::size_t kChecksumAt = 8;
  constexpr std::size_t kFrameAt = 12;
  if (bytes.size() >= kFrameAt) {
    const std::string_view all = bytes;
    const std::uint32_t start = storage::Crc32c(all.substr(0, kChecksumAt));
    PutUint32(storage::Crc32c(all.substr(kFrameAt), start), kChecksumAt, bytes);
  }
  const auto points = storage::UnpackCloud(bytes);
  if (!points.ok()) return;
  const auto packed = storage::PackCloud(*points);
  Require(packed.ok(), "unpacked points can be packed");
  const auto again = storage::UnpackCloud(*packed);
  Require(again.ok() && *again == *points, "the same points after packing");
}

void ReadBackupRecord(std::string_view bytes) {
  const auto record = storage::DecodeBackupRecord(storage::ToLittleEndian(storage::Crc32c(bytes)) +
                                                  std::string(bytes));
  if (!record.ok()) return;
  const auto again = storage::DecodeBackupRecord(storage::EncodeBackupRecord(*record));
  Require(again.ok() && again->SerializeAsString() == record->SerializeAsString(),
          "the same record after packing");
}

void Read(std::string_view bytes) {
  if (bytes.starts_with("GPC")) {
    ReadCloud(std::string(bytes));
  } else {
    storage::InspectLog(bytes);
    ReadBackupRecord(bytes);
  }
}

}  // namespace
}  // namespace graspdb::fuzz

GRASPDB_FUZZ_BYTES(graspdb::fuzz::Read)
