#include "storage/backups/watched_reads.h"

#include <atomic>
#include <cstdint>
#include <string>
#include <utility>

#include "rocksdb/file_system.h"

namespace graspdb::storage {
namespace {

class WatchedFile : public rocksdb::FSSequentialFileOwnerWrapper {
 public:
  WatchedFile(std::unique_ptr<rocksdb::FSSequentialFile> file, const BackupProgress& progress,
              std::atomic<std::int64_t>& bytes)
      : FSSequentialFileOwnerWrapper(std::move(file)), progress_(progress), bytes_(bytes) {}

  rocksdb::IOStatus Read(std::size_t size, const rocksdb::IOOptions& options,
                         rocksdb::Slice* result, char* scratch,
                         rocksdb::IODebugContext* context) override {
    if (progress_.IsCancelled()) return rocksdb::IOStatus::IOError("cancelled");
    rocksdb::IOStatus read =
        FSSequentialFileOwnerWrapper::Read(size, options, result, scratch, context);
    if (read.ok()) progress_.Report(bytes_ += static_cast<std::int64_t>(result->size()));
    return read;
  }

 private:
  const BackupProgress& progress_;
  std::atomic<std::int64_t>& bytes_;
};

class WatchedFiles : public rocksdb::FileSystemWrapper {
 public:
  explicit WatchedFiles(const BackupProgress& progress)
      : FileSystemWrapper(rocksdb::FileSystem::Default()), progress_(progress) {}
  const char* Name() const override { return "WatchedFiles"; }

  rocksdb::IOStatus NewSequentialFile(const std::string& name, const rocksdb::FileOptions& options,
                                      std::unique_ptr<rocksdb::FSSequentialFile>* file,
                                      rocksdb::IODebugContext* context) override {
    rocksdb::IOStatus opened = FileSystemWrapper::NewSequentialFile(name, options, file, context);
    if (opened.ok()) *file = std::make_unique<WatchedFile>(std::move(*file), progress_, bytes_);
    return opened;
  }

 private:
  const BackupProgress& progress_;
  std::atomic<std::int64_t> bytes_ = 0;
};

}  // namespace

std::unique_ptr<rocksdb::Env> WatchReads(const BackupProgress& progress) {
  return rocksdb::NewCompositeEnv(std::make_shared<WatchedFiles>(progress));
}

}  // namespace graspdb::storage
