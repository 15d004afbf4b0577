// Files of the database that are missing, too short, or found damaged by a read.
#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <system_error>

#include "storage/database/database.h"

namespace graspdb::storage {
namespace {

// Of those that are reported. More are of no use to who restores a backup.
constexpr std::size_t kMaxDamagedFiles = 20;

// The name of a file in an error of RocksDB, such as 000012.blob; empty without one.
std::string FileIn(std::string_view error) {
  for (const std::string_view extension : {".blob", ".sst"}) {
    const std::size_t end = error.find(extension);
    if (end == std::string_view::npos) continue;
    const std::size_t before = error.find_last_not_of("0123456789", end - 1);
    const std::size_t begin = before == std::string_view::npos ? 0 : before + 1;
    if (begin < end) return std::string(error.substr(begin, end + extension.size() - begin));
  }
  return {};
}

std::string NameOf(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

// The files that the database needs, with their sizes.
std::map<std::string, std::uint64_t> LiveFiles(
    rocksdb::DB& db, const std::vector<rocksdb::ColumnFamilyHandle*>& families) {
  std::map<std::string, std::uint64_t> out;
  for (rocksdb::ColumnFamilyHandle* family : families) {
    rocksdb::ColumnFamilyMetaData data;
    db.GetColumnFamilyMetaData(family, &data);
    for (const rocksdb::LevelMetaData& level : data.levels) {
      for (const rocksdb::SstFileMetaData& file : level.files) out[NameOf(file.name)] = file.size;
    }
    for (const rocksdb::BlobMetaData& file : data.blob_files) {
      out[NameOf(file.blob_file_name)] = file.blob_file_size;
    }
  }
  return out;
}

}  // namespace

void Database::NoteDamage(const std::string& error) const {
  std::string name = FileIn(error);
  if (name.empty()) return;
  absl::MutexLock lock(&fault_mutex_);
  if (damage_.size() < kMaxDamagedFiles) damage_.emplace(std::move(name), error);
}

std::vector<DamagedFile> Database::DamagedFiles() const {
  std::map<std::string, std::string> lost;
  for (const auto& [name, size] : LiveFiles(*db_, handles_)) {
    std::error_code error;
    const std::uintmax_t there = std::filesystem::file_size(directory_ + "/" + name, error);
    if (error) {
      lost[name] = error.message();
    } else if (there < size) {
      lost[name] = "has " + std::to_string(there) + " of " + std::to_string(size) + " bytes";
    }
  }
  // A compaction may have deleted them meanwhile.
  const std::map<std::string, std::uint64_t> live = LiveFiles(*db_, handles_);
  std::map<std::string, std::string> found = lost;
  {
    absl::MutexLock lock(&fault_mutex_);
    found.insert(damage_.begin(), damage_.end());
  }
  std::vector<DamagedFile> out;
  for (const auto& [name, error] : found) {
    if (!live.contains(name) || out.size() >= kMaxDamagedFiles) continue;
    out.push_back({.name = name, .error = error, .is_lost = lost.contains(name)});
  }
  return out;
}

}  // namespace graspdb::storage
