#include "storage/database/database_status.h"

#include <filesystem>
#include <system_error>

#include "storage/database/database.h"

namespace graspdb::storage {
namespace {

using Properties = rocksdb::DB::Properties;

// Of the default family: for figures of the whole database, or of its shared cache.
std::uint64_t Figure(rocksdb::DB& rocks, const std::string& property) {
  std::uint64_t out = 0;
  return rocks.GetIntProperty(property, &out) ? out : 0;
}

std::uint64_t SumOfFamilies(rocksdb::DB& rocks, const std::string& property) {
  std::uint64_t out = 0;
  return rocks.GetAggregatedIntProperty(property, &out) ? out : 0;
}

}  // namespace

DatabaseStatus StatusOf(Database& database) {
  rocksdb::DB& rocks = database.rocks();
  DatabaseStatus out;
  out.table_bytes = SumOfFamilies(rocks, Properties::kTotalSstFilesSize);
  out.blob_bytes = SumOfFamilies(rocks, Properties::kTotalBlobFileSize);
  out.memtable_bytes = SumOfFamilies(rocks, Properties::kCurSizeAllMemTables);
  out.block_cache_bytes = Figure(rocks, Properties::kBlockCacheUsage);
  out.pending_compaction_bytes = SumOfFamilies(rocks, Properties::kEstimatePendingCompactionBytes);
  out.running_compactions = Figure(rocks, Properties::kNumRunningCompactions);
  out.background_errors = Figure(rocks, Properties::kBackgroundErrors);
  out.writes_stopped = Figure(rocks, Properties::kIsWriteStopped) != 0;
  out.write_fault = database.write_fault();
  out.reserve_error = database.reserve_error();
  std::error_code error;
  const std::filesystem::space_info disk = std::filesystem::space(database.directory(), error);
  if (!error) {
    out.disk_available_bytes = disk.available;
    out.disk_bytes = disk.capacity;
  }
  return out;
}

}  // namespace graspdb::storage
