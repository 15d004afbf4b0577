// Room on the disk: what adds to the database ends before the disk is full, so that what frees
// space still succeeds. docs/adr/0037-a-reserve-for-what-frees-space.md
#include <algorithm>
#include <string>
#include <system_error>

#include "rocksdb/file_system.h"
#include "storage/database/database.h"
#include "storage/database/rocksdb_status.h"

namespace graspdb::storage {
namespace {

using Properties = rocksdb::DB::Properties;

// For what a flush writes besides the memtables' entries: tables' indexes, manifest, log.
constexpr std::uint64_t kFlushSpareBytes = 1U << 20;
// What additions leave beside a flush, so that one that is in progress does not take it.
constexpr std::uint64_t kAddSpareBytes = 4U << 20;
// The start writes the content of the logs to files, a little more than they have.
constexpr std::uint64_t kLogsPerReserve = 2;

std::uint64_t SumOf(rocksdb::DB& rocks, const std::string& property) {
  std::uint64_t out = 0;
  rocks.GetAggregatedIntProperty(property, &out);
  return out;
}

}  // namespace

std::uint64_t Database::RoomForFlush() const {
  return SumOf(*db_, Properties::kCurSizeAllMemTables) + kFlushSpareBytes;
}

bool Database::HasRoom(std::uint64_t bytes) const {
  std::uint64_t room = 0;
  const rocksdb::IOStatus measured =
      db_->GetFileSystem()->GetFreeSpace(directory_, rocksdb::IOOptions(), &room, nullptr);
  return !measured.ok() || room >= bytes;
}

void Database::PrepareReserve(rocksdb::DBOptions* options) {
  reserve_.Adopt();
  if (reserve_.bytes() == 0) return;
  options->max_total_wal_size =
      std::min(options->max_total_wal_size, reserve_.bytes() / kLogsPerReserve);
  std::uint64_t room = 0;
  const rocksdb::Status measured = options->env->GetFreeSpace(directory_, &room);
  if (measured.ok() && room < reserve_.bytes()) reserve_.Release();
}

void Database::MakeReserve() {
  reserve_.Take(RoomForFlush() + std::min(kAddSpareBytes, reserve_.bytes()));
}

void Database::TakeReserve() {
  if (reserve_.is_held()) return;
  MakeReserve();
}

std::string Database::reserve_error() const {
  const int failure = reserve_.failure();
  if (failure == 0) return {};
  return directory_ + "/" + kReserveFile + ": " + std::generic_category().message(failure);
}

absl::Status Database::CheckRoomToAdd() {
  if (reserve_.bytes() == 0) return absl::OkStatus();
  TakeReserve();
  if (reserve_.is_held() && HasRoom(RoomForFlush() + std::min(kAddSpareBytes, reserve_.bytes()))) {
    return absl::OkStatus();
  }
  absl::Status full = absl::ResourceExhaustedError(
      "the disk of the database is full but for a reserve, with which objects and uploads can "
      "still "
      "be deleted; free space on the disk, or run graspdb uploads delete or objects purge, and "
      "repeat the call");
  NoteFault(full);
  return full;
}

void Database::PrepareToFree(std::uint64_t bytes) {
  if (reserve_.bytes() == 0) return;
  if (!reserve_.is_held() || !HasRoom(RoomForFlush() + bytes)) {
    reserve_.Release();
    wants_compaction_ = true;
  }
  if (!is_failing_) return;
  // The attempt that waits for its time had no room.
  absl::MutexLock lock(&log_mutex_);
  if (absl::IsResourceExhausted(write_fault().error)) next_recovery_ = {};
}

void Database::CompactForRoom(std::atomic<bool>* cancelled) {
  if (reserve_.is_held() || is_failing_ || !wants_compaction_.exchange(false)) return;
  // Not Flush(), which wants a compaction again. After a failure one follows once writes succeed.
  if (!FlushPrepared().ok()) wants_compaction_ = true;
  rocksdb::CompactRangeOptions options;
  options.exclusive_manual_compaction = false;
  options.canceled = cancelled;
  // Blob files without a live cloud go when the rows that point to them are gone.
  options.blob_garbage_collection_policy = rocksdb::BlobGarbageCollectionPolicy::kDisable;
  Compact(options);
  TakeReserve();
  if (reserve_.is_held()) return;
  // To move the live clouds of other files takes as much room as they have. How much that is, is
  // known only now.
  const std::uint64_t live = SumOf(*db_, Properties::kLiveBlobFileSize) -
                             SumOf(*db_, Properties::kLiveBlobFileGarbageSize);
  if (!HasRoom(live + RoomForFlush())) return;
  options.bottommost_level_compaction = rocksdb::BottommostLevelCompaction::kForce;
  options.blob_garbage_collection_policy = rocksdb::BlobGarbageCollectionPolicy::kForce;
  options.blob_garbage_collection_age_cutoff = 1.0;
  Compact(options);
  TakeReserve();
}

void Database::Compact(const rocksdb::CompactRangeOptions& options) {
  for (rocksdb::ColumnFamilyHandle* family : handles_) {
    // What a compaction cannot write now, a later one of RocksDB does.
    db_->CompactRange(options, family, nullptr, nullptr).PermitUncheckedError();
  }
}

}  // namespace graspdb::storage
