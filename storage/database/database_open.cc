#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "base/status_macros.h"
#include "rocksdb/env.h"
#include "storage/database/database.h"
#include "storage/database/database_directory.h"
#include "storage/database/log_check.h"
#include "storage/database/rocksdb_options.h"
#include "storage/database/rocksdb_status.h"

namespace graspdb::storage {
namespace {

constexpr std::size_t kFileBytes = 4U << 20;
// Of a line; the longest that were seen are those of a compaction with many files.
constexpr std::size_t kLineBytes = 8192;

class TextLog : public rocksdb::Logger {
 public:
  explicit TextLog(std::string path) : path_(std::move(path)) {
    absl::MutexLock lock(&mutex_);
    Begin();
  }
  ~TextLog() override {
    if (file_ >= 0) close(file_);
  }

  using rocksdb::Logger::Logv;
  void Logv(const char* format, va_list arguments) override {
    std::array<char, kLineBytes> text;
    const int length = vsnprintf(text.data(), text.size(), format, arguments);
    if (length < 0) return;
    std::string line = absl::FormatTime("%Y/%m/%d-%H:%M:%E6S ", absl::Now(), absl::UTCTimeZone());
    line.append(text.data(), std::min(static_cast<std::size_t>(length), text.size() - 1));
    if (line.back() != '\n') line += '\n';
    absl::MutexLock lock(&mutex_);
    if (bytes_ > kFileBytes) Begin();
    const ssize_t written = write(file_, line.data(), line.size());
    bytes_ += static_cast<std::size_t>(std::max<ssize_t>(written, 0));
  }

 private:
  void Begin() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    if (file_ >= 0) close(file_);
    std::rename(path_.c_str(), (path_ + ".old").c_str());
    file_ = open(path_.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
    bytes_ = 0;
  }

  const std::string path_;
  absl::Mutex mutex_;
  int file_ ABSL_GUARDED_BY(mutex_) = -1;
  std::size_t bytes_ ABSL_GUARDED_BY(mutex_) = 0;
};

// Writes to LOG in `directory`, which exists, and begins a new file there at 4 MiB. Lines that
// cannot be written, since the disk is full, are left out: RocksDB's own log aborts the process
// then, at the line after one that failed (7.8 as Debian builds it, with assertions). Thread-safe.
std::shared_ptr<rocksdb::Logger> OpenTextLog(const std::string& directory) {
  return std::make_shared<TextLog>(directory + "/LOG");
}

// Checks an existing database, or makes an empty directory for a new one.
absl::Status PrepareDirectory(const std::string& directory, bool create_if_missing) {
  ASSIGN_OR_RETURN(const auto content, InspectDirectory(directory));
  if (content == DirectoryContent::kDatabase) return CheckLogs(directory);
  if (!create_if_missing) {
    return absl::NotFoundError("there is no database at " + directory + "; choose another --db");
  }
  return MakeDirectory(directory);
}

// The families of a database. A database of another program is rejected before RocksDB could
// change it.
absl::StatusOr<std::vector<std::string>> ListFamilies(const rocksdb::DBOptions& options,
                                                      const std::string& directory) {
  std::vector<std::string> names;
  const rocksdb::Status listed = rocksdb::DB::ListColumnFamilies(options, directory, &names);
  if (!listed.ok()) return FromRocksDbOpen(listed, directory);
  const auto known = [](const std::string& name) {
    return std::find(kFamilyNames.begin(), kFamilyNames.end(), name) != kFamilyNames.end();
  };
  const bool all_known = std::all_of(names.begin(), names.end(), known);
  const bool ours = std::count_if(names.begin(), names.end(), known) == kFamilyCount;
  if (all_known || ours) return names;  // of this program, or of a newer version of it
  return absl::FailedPreconditionError("the directory " + directory +
                                       " contains the database of another program; choose an empty "
                                       "directory or another --db");
}

// The families on disk; only the default one when there is no database yet.
absl::StatusOr<std::vector<std::string>> FamiliesToOpen(const rocksdb::DBOptions& options,
                                                        const std::string& directory) {
  ASSIGN_OR_RETURN(const auto content, InspectDirectory(directory));
  if (content == DirectoryContent::kDatabase) return ListFamilies(options, directory);
  return std::vector<std::string>{std::string(FamilyName(Family::kMeta))};
}

// Whether the lock is free. RocksDB takes it after the text log has begun a new file, which would
// take the old one from the process that has the database open. Of two processes that start at the
// same time, both may still get beyond this.
absl::Status CheckLock(rocksdb::Env& env, const std::string& directory) {
  rocksdb::FileLock* lock = nullptr;
  rocksdb::Status locked = env.LockFile(directory + "/LOCK", &lock);  // RocksDB's name
  if (locked.ok()) locked = env.UnlockFile(lock);
  return FromRocksDbOpen(locked, directory);
}

// RocksDB's own text log is not written for a database that is only read.
class NoLog : public rocksdb::Logger {
 public:
  using rocksdb::Logger::Logv;
  void Logv(const char* /*format*/, va_list /*arguments*/) override {}
};

}  // namespace

absl::StatusOr<std::unique_ptr<Database>> Database::Open(const std::string& directory,
                                                         const Options& options) {
  RETURN_IF_ERROR(PrepareDirectory(directory, options.create_if_missing));
  rocksdb::DBOptions db_options = MakeDbOptions(options.env);
  ASSIGN_OR_RETURN(const auto names, FamiliesToOpen(db_options, directory));
  RETURN_IF_ERROR(CheckLock(*db_options.env, directory));
  db_options.info_log = OpenTextLog(directory);

  std::unique_ptr<Database> database(new Database(directory, options));
  database->PrepareReserve(&db_options);
  rocksdb::DB* db = nullptr;
  std::vector<rocksdb::ColumnFamilyHandle*> handles;
  const rocksdb::Status opened =
      rocksdb::DB::Open(db_options, directory, database->Describe(names), &handles, &db);
  if (!opened.ok()) return FromRocksDbOpen(opened, directory);
  database->db_.reset(db);
  database->Adopt(handles);
  database->TakeReserve();
  // What an earlier process deleted may still take up space.
  database->wants_compaction_ = !database->reserve_.is_held();
  return database;
}

absl::StatusOr<std::unique_ptr<Database>> Database::OpenReadOnly(const std::string& directory,
                                                                 rocksdb::Env* env) {
  rocksdb::DBOptions db_options = MakeDbOptions(env);
  db_options.create_if_missing = false;
  db_options.info_log = std::make_shared<NoLog>();
  ASSIGN_OR_RETURN(const auto names, ListFamilies(db_options, directory));
  std::unique_ptr<Database> database(new Database(directory, Options()));
  database->is_read_only_ = true;
  rocksdb::DB* db = nullptr;
  std::vector<rocksdb::ColumnFamilyHandle*> handles;
  const rocksdb::Status opened =
      rocksdb::DB::OpenForReadOnly(db_options, directory, database->Describe(names), &handles, &db);
  if (!opened.ok()) return FromRocksDbOpen(opened, directory);
  database->db_.reset(db);
  database->Adopt(handles);
  return database;
}

}  // namespace graspdb::storage
