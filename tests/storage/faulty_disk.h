// A disk that drops unsynced bytes and names, and that fails or is full on request.
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <shared_mutex>
#include <string>

#include "rocksdb/env.h"
#include "rocksdb/file_system.h"

namespace graspdb::storage {

// Forwards everything to the machine's files, and notes the synced bytes and names.
// Safe from any thread.
class FaultyDisk : public rocksdb::FileSystemWrapper {
 public:
  FaultyDisk() : rocksdb::FileSystemWrapper(rocksdb::FileSystem::Default()) {}
  const char* Name() const override { return "FaultyDisk"; }

  rocksdb::IOStatus NewWritableFile(const std::string& name, const rocksdb::FileOptions& options,
                                    std::unique_ptr<rocksdb::FSWritableFile>* file,
                                    rocksdb::IODebugContext* context) override;
  rocksdb::IOStatus RenameFile(const std::string& from, const std::string& to,
                               const rocksdb::IOOptions& options,
                               rocksdb::IODebugContext* context) override;

  rocksdb::IOStatus DeleteFile(const std::string& name, const rocksdb::IOOptions& options,
                               rocksdb::IODebugContext* context) override;
  rocksdb::IOStatus NewDirectory(const std::string& name, const rocksdb::IOOptions& options,
                                 std::unique_ptr<rocksdb::FSDirectory>* directory,
                                 rocksdb::IODebugContext* context) override;
  rocksdb::IOStatus GetFreeSpace(const std::string& path, const rocksdb::IOOptions& options,
                                 std::uint64_t* space, rocksdb::IODebugContext* context) override;

  // Stops all further changes to this disk, including pending ones.
  void Stop() { stopped_ = true; }
  // Truncates every file written through this disk, as found in `directory`, to its synced bytes,
  // and undoes renames and new names since the last sync of their directory.
  void LosePower(const std::string& directory);
  // Copies the files of an open database as they are at one moment: no write, sync, rename or
  // deletion of a flush falls in between.
  enum class Unsynced : std::uint8_t { kKept, kLost };
  void CopyOpen(const std::string& from, const std::string& to, Unsynced bytes);
  // Bytes that can still be written to files.
  void SetSpace(std::int64_t bytes) { space_ = bytes; }
  std::int64_t space() const { return space_; }
  // What is left after the next call of GetFreeSpace(), as if another took the rest.
  void TakeMeasuredSpace(std::int64_t left) { left_after_measurement_ = left; }
  static constexpr std::int64_t kMuchSpace = std::numeric_limits<std::int64_t>::max() / 2;
  int syncs_of_logs() const { return syncs_of_logs_; }
  void FailSyncsOfLogs(bool fail) { fail_syncs_of_logs_ = fail; }
  // Whether all files fail, as on a file system that became read-only.
  void FailFiles(bool fail) { fail_files_ = fail; }
  // Whether a new log finds no place in its folder, as on a disk without free inodes.
  void FailNewLogs(bool fail) { fail_new_logs_ = fail; }
  // Whether GetFreeSpace() is supported.
  void ReportSpace(bool report) { report_space_ = report; }
  // The next `count` sorted files that end find the disk full, or another error of it, each after a
  // while, as a flush that began when there was room.
  void FailSortedFiles(int count, bool is_full = true) {
    sorted_files_find_it_full_ = is_full;
    failing_sorted_files_ = count;
  }
  // Whether compactions find the disk full.
  void FailCompactions(bool fail) { fail_compactions_ = fail; }
  int failed_compactions() const { return failed_compactions_; }

  // For the files of this disk.
  rocksdb::IOStatus Synced(const std::string& name, std::uint64_t size);
  rocksdb::IOStatus NamesSynced(const std::string& directory);
  // An error for a sorted file that is to fail.
  rocksdb::IOStatus SortedFileMayEnd();
  // Takes up to `bytes` of the space and returns how many.
  std::size_t Take(std::size_t bytes);
  // An error once the disk has stopped, or while files fail.
  rocksdb::IOStatus Running() const;
  // Held while files change.
  std::shared_lock<std::shared_mutex> Changing() { return std::shared_lock(changing_); }

 private:
  std::shared_mutex changing_;
  std::mutex mutex_;
  std::map<std::string, std::uint64_t> synced_;  // by path
  // Paths whose names changed since the last sync: the bytes that they had before, if they existed.
  std::map<std::string, std::optional<std::string>> renamed_;
  static constexpr std::int64_t kNothingTaken = -1;
  std::atomic<std::int64_t> space_ = kMuchSpace;
  std::atomic<int> syncs_of_logs_ = 0;
  std::atomic<bool> fail_syncs_of_logs_ = false;
  std::atomic<std::int64_t> left_after_measurement_ = kNothingTaken;
  std::atomic<bool> fail_files_ = false;
  std::atomic<bool> fail_new_logs_ = false;
  std::atomic<bool> report_space_ = true;
  std::atomic<int> failing_sorted_files_ = 0;
  std::atomic<bool> sorted_files_find_it_full_ = true;
  std::atomic<bool> fail_compactions_ = false;
  std::atomic<int> failed_compactions_ = 0;
  std::atomic<bool> stopped_ = false;
};

}  // namespace graspdb::storage
