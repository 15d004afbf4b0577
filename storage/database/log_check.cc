#include "storage/database/log_check.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "storage/base/crc32c.h"
#include "storage/base/little_endian.h"
#include "storage/base/restore_advice.h"
#include "storage/base/whole_file.h"

namespace graspdb::storage {
namespace {

// RocksDB's log format: blocks of 32 KiB, filled with physical records of
// checksum (4 bytes), length (2), type (1), payload. No record crosses a block; a
// write that does not fit is cut into a first, middle and last records.
constexpr std::size_t kBlockSize = 32768;
constexpr std::size_t kHeaderSize = 7;
// A batch starts with a sequence number (8 bytes) and a count (4). One without entries
// is a mark that RocksDB leaves when it recovers, not a write.
constexpr std::size_t kEmptyBatchSize = 12;

enum RecordType : unsigned char { kZero = 0, kFull = 1, kFirst = 2, kMiddle = 3, kLast = 4 };

struct Record {
  RecordType type;
  std::size_t size;  // of the payload
};

// The intact record at `offset`, if there is one.
std::optional<Record> ReadRecord(std::string_view log, std::size_t offset) {
  const std::size_t block_end = std::min(log.size(), (offset / kBlockSize + 1) * kBlockSize);
  if (offset + kHeaderSize > block_end) return std::nullopt;
  const auto type = static_cast<unsigned char>(log[offset + 6]);
  const std::size_t size = FromLittleEndian(log.substr(offset + 4, 2));
  if (type < kFull || type > kLast || offset + kHeaderSize + size > block_end) return std::nullopt;
  // RocksDB rotates the checksum and adds a constant, because a checksum of data that
  // contains checksums is weak.
  const std::uint32_t rotated = FromLittleEndian(log.substr(offset, 4)) - 0xa282ead8U;
  const std::uint32_t checksum = (rotated >> 17) | (rotated << 15);
  if (Crc32c(log.substr(offset + 6, size + 1)) != checksum) return std::nullopt;
  return Record{static_cast<RecordType>(type), size};
}

// Whether an intact write begins anywhere after `offset`. Middle and last records do
// not count: they may belong to the write that the crash truncated, because a disk may
// keep the later pages of a write and lose the earlier ones.
bool WriteBeginsBehind(std::string_view log, std::size_t offset) {
  for (std::size_t i = offset + 1; i + kHeaderSize <= log.size(); ++i) {
    const auto type = static_cast<unsigned char>(log[i + 6]);
    if ((type == kFull || type == kFirst) && ReadRecord(log, i).has_value()) return true;
  }
  return false;
}

absl::Status Damaged(const std::filesystem::path& file) {
  return absl::DataLossError("the file " + file.string() + " is damaged; " +
                             std::string(kRestoreAdvice));
}

// Logs by ascending number (their names have leading zeros), then manifests.
struct LogFiles {
  std::vector<std::filesystem::path> logs;
  std::vector<std::filesystem::path> manifests;
};

LogFiles FindLogs(const std::string& directory) {
  LogFiles found;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(directory, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (entry->path().extension() == ".log") found.logs.push_back(entry->path());
    if (name.starts_with("MANIFEST-")) found.manifests.push_back(entry->path());
  }
  std::sort(found.logs.begin(), found.logs.end());
  return found;
}

}  // namespace

LogVerdict InspectLog(std::string_view log) {
  LogVerdict verdict;
  bool inside_write = false;
  std::size_t offset = 0;
  while (offset < log.size()) {
    const std::size_t left_in_block = kBlockSize - offset % kBlockSize;
    if (left_in_block < kHeaderSize) {
      offset += left_in_block;
      continue;
    }
    const std::optional<Record> record = ReadRecord(log, offset);
    const bool begins = record && (record->type == kFull || record->type == kFirst);
    if (!record || begins == inside_write) {
      // A begin inside a write is itself the intact write after the damage.
      verdict.damaged = begins || WriteBeginsBehind(log, offset);
      verdict.complete = !verdict.damaged && log.find_first_not_of('\0', offset) == log.npos;
      break;
    }
    inside_write = record->type == kFirst || record->type == kMiddle;
    verdict.has_writes |=
        record->type == kLast || (record->type == kFull && record->size > kEmptyBatchSize);
    offset += kHeaderSize + record->size;
  }
  verdict.complete &= !inside_write;
  return verdict;
}

absl::Status CheckLogs(const std::string& directory) {
  const LogFiles files = FindLogs(directory);
  std::optional<std::filesystem::path> incomplete;
  for (const std::filesystem::path& path : files.logs) {
    const absl::StatusOr<std::string> log = ReadWholeFile(path);
    if (!log.ok()) continue;
    const LogVerdict verdict = InspectLog(*log);
    if (verdict.damaged) return Damaged(path);
    if (incomplete && verdict.has_writes) return Damaged(*incomplete);
    if (!verdict.complete) incomplete = path;
  }
  for (const std::filesystem::path& path : files.manifests) {
    const absl::StatusOr<std::string> manifest = ReadWholeFile(path);
    if (manifest.ok() && InspectLog(*manifest).damaged) return Damaged(path);
  }
  return absl::OkStatus();
}

}  // namespace graspdb::storage
