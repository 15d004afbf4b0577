#include "tests/storage/faulty_disk.h"

#include <algorithm>
#include <filesystem>
#include <utility>

namespace graspdb::storage {
namespace {

class WatchedFile : public rocksdb::FSWritableFileOwnerWrapper {
 public:
  WatchedFile(std::unique_ptr<rocksdb::FSWritableFile> file, std::string name, FaultyDisk* disk)
      : FSWritableFileOwnerWrapper(std::move(file)), name_(std::move(name)), disk_(disk) {}

  rocksdb::IOStatus Append(const rocksdb::Slice& data, const rocksdb::IOOptions& options,
                           rocksdb::IODebugContext* context) override {
    if (auto running = disk_->Running(); !running.ok()) return running;
    size_ += data.size();
    return FSWritableFileOwnerWrapper::Append(data, options, context);
  }
  rocksdb::IOStatus Append(const rocksdb::Slice& data, const rocksdb::IOOptions& options,
                           const rocksdb::DataVerificationInfo& info,
                           rocksdb::IODebugContext* context) override {
    if (auto running = disk_->Running(); !running.ok()) return running;
    size_ += data.size();
    return FSWritableFileOwnerWrapper::Append(data, options, info, context);
  }
  rocksdb::IOStatus Sync(const rocksdb::IOOptions& options,
                         rocksdb::IODebugContext* context) override {
    const rocksdb::IOStatus allowed = disk_->Synced(name_, size_);
    return allowed.ok() ? FSWritableFileOwnerWrapper::Sync(options, context) : allowed;
  }
  rocksdb::IOStatus Fsync(const rocksdb::IOOptions& options,
                          rocksdb::IODebugContext* context) override {
    const rocksdb::IOStatus allowed = disk_->Synced(name_, size_);
    return allowed.ok() ? FSWritableFileOwnerWrapper::Fsync(options, context) : allowed;
  }

 private:
  const std::string name_;
  FaultyDisk* const disk_;
  std::uint64_t size_ = 0;
};

}  // namespace

rocksdb::IOStatus FaultyDisk::NewWritableFile(const std::string& name,
                                              const rocksdb::FileOptions& options,
                                              std::unique_ptr<rocksdb::FSWritableFile>* file,
                                              rocksdb::IODebugContext* context) {
  if (auto running = Running(); !running.ok()) return running;
  std::unique_ptr<rocksdb::FSWritableFile> inner;
  rocksdb::IOStatus made = target()->NewWritableFile(name, options, &inner, context);
  if (!made.ok()) return made;
  *file = std::make_unique<WatchedFile>(std::move(inner), name, this);
  const std::scoped_lock lock(mutex_);
  synced_[name] = 0;
  return made;
}

rocksdb::IOStatus FaultyDisk::RenameFile(const std::string& from, const std::string& to,
                                         const rocksdb::IOOptions& options,
                                         rocksdb::IODebugContext* context) {
  if (auto running = Running(); !running.ok()) return running;
  rocksdb::IOStatus renamed = target()->RenameFile(from, to, options, context);
  const std::scoped_lock lock(mutex_);
  if (const auto file = synced_.find(from); renamed.ok() && file != synced_.end()) {
    synced_[to] = file->second;
    synced_.erase(file);
  }
  return renamed;
}

rocksdb::IOStatus FaultyDisk::DeleteFile(const std::string& name, const rocksdb::IOOptions& options,
                                         rocksdb::IODebugContext* context) {
  if (auto running = Running(); !running.ok()) return running;
  return target()->DeleteFile(name, options, context);
}

rocksdb::IOStatus FaultyDisk::Running() const {
  if (stopped_) return rocksdb::IOStatus::IOError("the power is gone");
  return rocksdb::IOStatus::OK();
}

rocksdb::IOStatus FaultyDisk::Synced(const std::string& name, std::uint64_t size) {
  const bool is_log = name.ends_with(".log");
  if (is_log && fail_syncs_of_logs_) return rocksdb::IOStatus::IOError("the disk is on fire");
  if (auto running = Running(); !running.ok()) return running;
  if (is_log) ++syncs_of_logs_;
  const std::scoped_lock lock(mutex_);
  synced_[name] = size;
  return rocksdb::IOStatus::OK();
}

void FaultyDisk::LosePower(const std::string& directory) {
  const std::scoped_lock lock(mutex_);
  for (const auto& [name, size] : synced_) {
    const std::filesystem::path path =
        std::filesystem::path(directory) / std::filesystem::path(name).filename();
    std::error_code missing;
    const std::uintmax_t written = std::filesystem::file_size(path, missing);
    if (missing) continue;
    std::filesystem::resize_file(path, std::min<std::uintmax_t>(written, size));
  }
}

}  // namespace graspdb::storage
