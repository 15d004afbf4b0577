#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "base/status_macros.h"
#include "rocksdb/env.h"
#include "storage/database/database.h"
#include "storage/database/database_directory.h"
#include "storage/database/log_check.h"
#include "storage/database/rocksdb_options.h"
#include "storage/database/rocksdb_status.h"
#include "storage/database/text_log.h"

namespace graspdb::storage {
namespace {

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
