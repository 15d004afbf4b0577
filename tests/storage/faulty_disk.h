// A disk that drops unsynced bytes, and that fails on request.
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "rocksdb/env.h"
#include "rocksdb/file_system.h"

namespace graspdb::storage {

// Forwards everything to the machine's files, and counts the synced bytes.
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

  // Stops all further changes to this disk, including pending ones.
  void Stop() { stopped_ = true; }
  // Truncates every file written through this disk, as found in `directory`, to its synced bytes.
  void LosePower(const std::string& directory);
  int syncs_of_logs() const { return syncs_of_logs_; }
  void FailSyncsOfLogs(bool fail) { fail_syncs_of_logs_ = fail; }

  // For the files of this disk.
  rocksdb::IOStatus Synced(const std::string& name, std::uint64_t size);
  // An error once the disk has stopped.
  rocksdb::IOStatus Running() const;

 private:
  std::mutex mutex_;
  std::map<std::string, std::uint64_t> synced_;  // by path
  std::atomic<int> syncs_of_logs_ = 0;
  std::atomic<bool> fail_syncs_of_logs_ = false;
  std::atomic<bool> stopped_ = false;
};

}  // namespace graspdb::storage
