#include "tests/storage/faulty_disk.h"

#include <pthread.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <string_view>
#include <thread>
#include <utility>

#include "tests/storage/catalogue_fixture.h"

namespace graspdb::storage {
namespace {

class WatchedFile : public rocksdb::FSWritableFileOwnerWrapper {
 public:
  WatchedFile(std::unique_ptr<rocksdb::FSWritableFile> file, std::string name, FaultyDisk* disk)
      : FSWritableFileOwnerWrapper(std::move(file)), name_(std::move(name)), disk_(disk) {}

  rocksdb::IOStatus Append(const rocksdb::Slice& data, const rocksdb::IOOptions& options,
                           rocksdb::IODebugContext* context) override {
    const auto changing = disk_->Changing();
    if (auto running = disk_->Running(); !running.ok()) return running;
    const std::size_t taken = disk_->Take(data.size());
    size_ += taken;
    rocksdb::IOStatus done =
        FSWritableFileOwnerWrapper::Append({data.data(), taken}, options, context);
    return done.ok() && taken < data.size() ? rocksdb::IOStatus::NoSpace("no byte left") : done;
  }
  rocksdb::IOStatus Append(const rocksdb::Slice& data, const rocksdb::IOOptions& options,
                           const rocksdb::DataVerificationInfo& /*info*/,
                           rocksdb::IODebugContext* context) override {
    return Append(data, options, context);
  }
  rocksdb::IOStatus Sync(const rocksdb::IOOptions& options,
                         rocksdb::IODebugContext* context) override {
    const auto changing = disk_->Changing();
    const rocksdb::IOStatus allowed = disk_->Synced(name_, size_);
    return allowed.ok() ? FSWritableFileOwnerWrapper::Sync(options, context) : allowed;
  }
  rocksdb::IOStatus Fsync(const rocksdb::IOOptions& options,
                          rocksdb::IODebugContext* context) override {
    const auto changing = disk_->Changing();
    const rocksdb::IOStatus allowed = disk_->Synced(name_, size_);
    return allowed.ok() ? FSWritableFileOwnerWrapper::Fsync(options, context) : allowed;
  }

 private:
  const std::string name_;
  FaultyDisk* const disk_;
  std::uint64_t size_ = 0;
};

class WatchedDirectory : public rocksdb::FSDirectoryWrapper {
 public:
  WatchedDirectory(std::unique_ptr<rocksdb::FSDirectory> directory, std::string name,
                   FaultyDisk* disk)
      : FSDirectoryWrapper(std::move(directory)), name_(std::move(name)), disk_(disk) {}

  rocksdb::IOStatus Fsync(const rocksdb::IOOptions& options,
                          rocksdb::IODebugContext* context) override {
    const auto changing = disk_->Changing();
    const rocksdb::IOStatus allowed = disk_->NamesSynced(name_);
    return allowed.ok() ? FSDirectoryWrapper::Fsync(options, context) : allowed;
  }
  rocksdb::IOStatus FsyncWithDirOptions(const rocksdb::IOOptions& options,
                                        rocksdb::IODebugContext* context,
                                        const rocksdb::DirFsyncOptions& what) override {
    const auto changing = disk_->Changing();
    const rocksdb::IOStatus allowed = disk_->NamesSynced(name_);
    return allowed.ok() ? FSDirectoryWrapper::FsyncWithDirOptions(options, context, what) : allowed;
  }

 private:
  const std::string name_;
  FaultyDisk* const disk_;
};

// Without the slash at its end and doubled ones.
std::string Normal(const std::string& path) {
  std::filesystem::path normal = std::filesystem::path(path).lexically_normal();
  return normal.has_filename() ? normal.string() : normal.parent_path().string();
}

// RocksDB names its threads by their priority; flushes have the high one.
bool IsCompactionThread() {
  std::array<char, 16> name{};
  pthread_getname_np(pthread_self(), name.data(), name.size());
  return std::string_view(name.data()) == "rocksdb:low";
}

std::optional<std::string> BytesIfThere(const std::string& path) {
  if (!std::filesystem::exists(path)) return std::nullopt;
  return ReadBytes(path);
}

}  // namespace

rocksdb::IOStatus FaultyDisk::NewWritableFile(const std::string& name,
                                              const rocksdb::FileOptions& options,
                                              std::unique_ptr<rocksdb::FSWritableFile>* file,
                                              rocksdb::IODebugContext* context) {
  const auto changing = Changing();
  if (auto running = Running(); !running.ok()) return running;
  if (fail_new_logs_ && name.ends_with(".log")) return rocksdb::IOStatus::NoSpace("no inode left");
  std::optional<std::string> before = BytesIfThere(name);
  std::unique_ptr<rocksdb::FSWritableFile> inner;
  rocksdb::IOStatus made = target()->NewWritableFile(name, options, &inner, context);
  if (!made.ok()) return made;
  *file = std::make_unique<WatchedFile>(std::move(inner), name, this);
  const std::scoped_lock lock(mutex_);
  synced_[name] = 0;
  renamed_.try_emplace(Normal(name), std::move(before));
  return made;
}

rocksdb::IOStatus FaultyDisk::RenameFile(const std::string& from, const std::string& to,
                                         const rocksdb::IOOptions& options,
                                         rocksdb::IODebugContext* context) {
  const auto changing = Changing();
  if (auto running = Running(); !running.ok()) return running;
  std::optional<std::string> before = BytesIfThere(to);
  rocksdb::IOStatus renamed = target()->RenameFile(from, to, options, context);
  const std::scoped_lock lock(mutex_);
  if (renamed.ok()) renamed_.try_emplace(Normal(to), std::move(before));
  if (const auto file = synced_.find(from); renamed.ok() && file != synced_.end()) {
    synced_[to] = file->second;
    synced_.erase(file);
  }
  return renamed;
}

rocksdb::IOStatus FaultyDisk::DeleteFile(const std::string& name, const rocksdb::IOOptions& options,
                                         rocksdb::IODebugContext* context) {
  const auto changing = Changing();
  if (auto running = Running(); !running.ok()) return running;
  return target()->DeleteFile(name, options, context);
}

rocksdb::IOStatus FaultyDisk::NewDirectory(const std::string& name,
                                           const rocksdb::IOOptions& options,
                                           std::unique_ptr<rocksdb::FSDirectory>* directory,
                                           rocksdb::IODebugContext* context) {
  std::unique_ptr<rocksdb::FSDirectory> inner;
  rocksdb::IOStatus made = target()->NewDirectory(name, options, &inner, context);
  if (made.ok()) {
    *directory = std::make_unique<WatchedDirectory>(std::move(inner), Normal(name), this);
  }
  return made;
}

rocksdb::IOStatus FaultyDisk::GetFreeSpace(const std::string& /*path*/,
                                           const rocksdb::IOOptions& /*options*/,
                                           std::uint64_t* space,
                                           rocksdb::IODebugContext* /*context*/) {
  if (!report_space_) return rocksdb::IOStatus::NotSupported();
  *space = static_cast<std::uint64_t>(space_.load());
  const std::int64_t left = left_after_measurement_.exchange(kNothingTaken);
  if (left != kNothingTaken) space_ = left;
  return rocksdb::IOStatus::OK();
}

rocksdb::IOStatus FaultyDisk::Running() const {
  if (stopped_) return rocksdb::IOStatus::IOError("the power is gone");
  if (fail_files_) return rocksdb::IOStatus::IOError("Read-only file system");
  return rocksdb::IOStatus::OK();
}

rocksdb::IOStatus FaultyDisk::Synced(const std::string& name, std::uint64_t size) {
  const bool is_log = name.ends_with(".log");
  if (is_log && fail_syncs_of_logs_) return rocksdb::IOStatus::IOError("the disk is on fire");
  if (auto running = Running(); !running.ok()) return running;
  if (is_log) ++syncs_of_logs_;
  if (name.ends_with(".sst")) {
    if (auto may_end = SortedFileMayEnd(); !may_end.ok()) return may_end;
  }
  const std::scoped_lock lock(mutex_);
  synced_[name] = size;
  return rocksdb::IOStatus::OK();
}

rocksdb::IOStatus FaultyDisk::NamesSynced(const std::string& directory) {
  if (auto running = Running(); !running.ok()) return running;
  const std::scoped_lock lock(mutex_);
  std::erase_if(renamed_, [&](const auto& change) {
    return std::filesystem::path(change.first).parent_path() == directory;
  });
  return rocksdb::IOStatus::OK();
}

rocksdb::IOStatus FaultyDisk::SortedFileMayEnd() {
  rocksdb::IOStatus full = rocksdb::IOStatus::NoSpace("no byte left");
  if (fail_compactions_ && IsCompactionThread()) {
    ++failed_compactions_;
    return full;
  }
  if (failing_sorted_files_ <= 0) return rocksdb::IOStatus::OK();
  --failing_sorted_files_;
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  return sorted_files_find_it_full_ ? full : rocksdb::IOStatus::IOError("Input/output error");
}

std::size_t FaultyDisk::Take(std::size_t bytes) {
  std::int64_t left = space_;
  std::int64_t taken = 0;
  do {
    taken = std::min(left, static_cast<std::int64_t>(bytes));
  } while (!space_.compare_exchange_weak(left, left - taken));
  return static_cast<std::size_t>(taken);
}

void FaultyDisk::CopyOpen(const std::string& from, const std::string& to, Unsynced bytes) {
  const std::unique_lock nothing_changes(changing_);
  CopyDatabase(from, to);
  if (bytes == Unsynced::kLost) LosePower(to);
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
  for (const auto& [name, before] : renamed_) {
    const std::filesystem::path path =
        std::filesystem::path(directory) / std::filesystem::path(name).filename();
    if (before) {
      WriteBytes(path, *before);
    } else {
      std::filesystem::remove(path);
    }
  }
}

}  // namespace graspdb::storage
