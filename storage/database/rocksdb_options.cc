#include "storage/database/rocksdb_options.h"

#include <cstdint>
#include <limits>

#include "rocksdb/cache.h"
#include "rocksdb/file_checksum.h"
#include "rocksdb/listener.h"
#include "rocksdb/table.h"
#include "storage/database/family.h"

namespace graspdb::storage {
namespace {

constexpr std::uint64_t kMaxWalBytes = 64ULL << 20;
constexpr std::uint64_t kBlobFileBytes = 64ULL << 20;
constexpr std::uint64_t kMinBlobBytes = 4096;
constexpr int kMaxOpenFiles = 512;

// Database::Recover() replaces the automatic recovery, which does not replace a torn log, and which
// can wait for ever with atomic_flush (https://github.com/facebook/rocksdb/pull/11872).
class NoAutomaticRecovery : public rocksdb::EventListener {
 public:
  void OnErrorRecoveryBegin(rocksdb::BackgroundErrorReason /*reason*/, rocksdb::Status /*error*/,
                            bool* automatic) override {
    *automatic = false;
  }
  // RocksDB repeats a compaction that a file failed, and writes need none of its results. As an
  // error of the database it would let the next atomic flush fail and never be repeated.
  // Errors of files during a write or a flush are the ones that DB::Resume() can end, as those of a
  // full disk: it writes the memtables, which have all acknowledged writes, to new files.
  void OnBackgroundError(rocksdb::BackgroundErrorReason reason, rocksdb::Status* error) override {
    if (!error->IsIOError()) return;
    if (reason == rocksdb::BackgroundErrorReason::kCompaction) {
      *error = rocksdb::Status::OK();
    } else if (error->severity() > rocksdb::Status::Severity::kHardError) {
      *error = rocksdb::Status(*error, rocksdb::Status::Severity::kHardError);
    }
  }
};

}  // namespace

rocksdb::DBOptions MakeDbOptions(rocksdb::Env* env) {
  rocksdb::DBOptions options;
  if (env != nullptr) options.env = env;
  options.create_if_missing = true;  // the caller has inspected the directory before
  options.paranoid_checks = true;
  // A crash may truncate the last write; replay stops before it. CheckLogs() makes sure
  // that replay does not stop at earlier damage.
  options.wal_recovery_mode = rocksdb::WALRecoveryMode::kPointInTimeRecovery;
  options.track_and_verify_wals_in_manifest = true;
  // All families are flushed together, so that even without its log a database is the
  // catalogue of some revision, and no idle family keeps old logs alive.
  options.atomic_flush = true;
  options.avoid_flush_during_shutdown = true;  // the log has all but Database::WriteToLog()'s mark
  // The manifest has the checksum of every file: a backup detects damaged files as it copies them,
  // and does not read those that it has already.
  options.file_checksum_gen_factory = rocksdb::GetFileChecksumGenCrc32cFactory();
  options.max_total_wal_size = kMaxWalBytes;
  options.max_open_files = kMaxOpenFiles;  // below the usual limit of 1024 descriptors
  options.bytes_per_sync = 1 << 20;
  options.listeners.push_back(std::make_shared<NoAutomaticRecovery>());
  return options;
}

rocksdb::ColumnFamilyOptions MakeFamilyOptions(std::string_view name,
                                               std::size_t write_buffer_bytes,
                                               const std::shared_ptr<rocksdb::Cache>& block_cache) {
  rocksdb::ColumnFamilyOptions options;
  options.write_buffer_size = write_buffer_bytes;
  // Writes and flushes wait for no compaction: while it finds the disk full, they would for ever,
  // since that is no error of the database (NoAutomaticRecovery).
  options.level0_slowdown_writes_trigger = std::numeric_limits<int>::max();
  options.level0_stop_writes_trigger = std::numeric_limits<int>::max();
  options.paranoid_file_checks = true;  // read a file back before its log is deleted
  options.compression = rocksdb::kLZ4Compression;
  rocksdb::BlockBasedTableOptions table;
  table.block_cache = block_cache;
  table.format_version = 5;
  options.table_factory.reset(rocksdb::NewBlockBasedTableFactory(table));
  if (name == FamilyName(Family::kClouds)) {
    // Clouds are written once and read whole: outside the sorted files, compactions do
    // not copy them. They are compressed already.
    options.enable_blob_files = true;
    options.min_blob_size = kMinBlobBytes;
    options.blob_file_size = kBlobFileBytes;
    options.blob_compression_type = rocksdb::kNoCompression;
    options.enable_blob_garbage_collection = true;
    options.compression = rocksdb::kNoCompression;
  }
  return options;
}

}  // namespace graspdb::storage
