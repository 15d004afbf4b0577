#include "storage/database/database.h"

#include <algorithm>
#include <utility>

#include "absl/strings/escaping.h"
#include "base/status_macros.h"
#include "rocksdb/cache.h"
#include "storage/database/rocksdb_options.h"
#include "storage/database/rocksdb_status.h"

namespace graspdb::storage {
namespace {

// Small, since callers cache records that they use often.
constexpr std::size_t kBlockCacheBytes = 16U << 20;

rocksdb::Slice ToSlice(std::string_view text) { return {text.data(), text.size()}; }
std::string_view ToView(const rocksdb::Slice& slice) { return {slice.data(), slice.size()}; }

// The first key after all keys with this prefix; empty when there is none. The
// prefixes in use are short and end in '/'.
std::string EndOfPrefix(std::string_view prefix) {
  std::string end(prefix);
  while (!end.empty() && static_cast<unsigned char>(end.back()) == 0xff) end.pop_back();
  if (!end.empty()) end.back() = static_cast<char>(static_cast<unsigned char>(end.back()) + 1);
  return end;
}

}  // namespace

Database::Database(std::string directory, const Options& options)
    : directory_(std::move(directory)),
      write_buffer_bytes_(options.write_buffer_bytes),
      block_cache_(rocksdb::NewLRUCache(kBlockCacheBytes)),
      reserve_(directory_, options.reserve_bytes),
      folder_(FolderIdOf(directory_)) {}

std::vector<rocksdb::ColumnFamilyDescriptor> Database::Describe(
    const std::vector<std::string>& families) const {
  std::vector<rocksdb::ColumnFamilyDescriptor> described;
  described.reserve(families.size());
  for (const std::string& name : families) {
    described.emplace_back(name, MakeFamilyOptions(name, write_buffer_bytes_, block_cache_));
  }
  return described;
}

Database::~Database() {
  if (db_ == nullptr) return;
  if (!is_read_only_) {
    // Every acknowledged write is in the synced log; an error here can lose nothing.
    FlushLargeLogs();
    TakeReserve();  // it was used for that
  }
  for (rocksdb::ColumnFamilyHandle* handle : handles_) {
    db_->DestroyColumnFamilyHandle(handle).PermitUncheckedError();
  }
  db_->Close().PermitUncheckedError();
}

void Database::Adopt(const std::vector<rocksdb::ColumnFamilyHandle*>& handles) {
  for (rocksdb::ColumnFamilyHandle* handle : handles) {
    handles_.push_back(handle);
    const auto name = std::find(kFamilyNames.begin(), kFamilyNames.end(), handle->GetName());
    if (name == kFamilyNames.end()) continue;
    families_[static_cast<std::size_t>(name - kFamilyNames.begin())] = handle;
  }
}

bool Database::IsPristine() const { return db_->GetLatestSequenceNumber() == 0; }

bool Database::HasAllFamilies() const {
  return std::find(families_.begin(), families_.end(), nullptr) == families_.end();
}

bool Database::HasFamily(Family family) const {
  return families_[static_cast<std::size_t>(family)] != nullptr;
}

absl::Status Database::CreateMissingFamilies() {
  if (HasAllFamilies()) return absl::OkStatus();
  std::vector<std::string> missing;
  for (std::size_t i = 0; i < kFamilyCount; ++i) {
    if (families_[i] == nullptr) missing.emplace_back(kFamilyNames[i]);
  }
  std::vector<rocksdb::ColumnFamilyHandle*> handles;
  const rocksdb::Status created = db_->CreateColumnFamilies(Describe(missing), &handles);
  Adopt(handles);
  return FromRocksDb(created, "create the column families");
}

absl::StatusOr<std::string> Database::Get(Family family, std::string_view key,
                                          const rocksdb::Snapshot* snapshot) const {
  rocksdb::ReadOptions options;
  options.snapshot = snapshot;
  std::string value;
  const rocksdb::Status read = db_->Get(options, Handle(family), ToSlice(key), &value);
  if (read.IsCorruption() || read.IsPathNotFound()) NoteDamage(read.ToString());
  if (!read.ok()) return FromRocksDb(read, "read " + absl::CHexEscape(std::string(key)));
  return value;
}

absl::StatusOr<bool> Database::Contains(Family family, std::string_view key) const {
  rocksdb::PinnableSlice value;
  const rocksdb::Status read =
      db_->Get(rocksdb::ReadOptions(), Handle(family), ToSlice(key), &value);
  if (read.IsNotFound()) return false;
  if (!read.ok()) return FromRocksDb(read, "read " + absl::CHexEscape(std::string(key)));
  return true;
}

absl::Status Database::Scan(Family family, std::string_view prefix, std::string_view after,
                            RowVisitor visit, const rocksdb::Snapshot* snapshot) const {
  const std::string end = EndOfPrefix(prefix);
  const rocksdb::Slice upper_bound(end);
  rocksdb::ReadOptions options;
  options.snapshot = snapshot;
  if (!end.empty()) options.iterate_upper_bound = &upper_bound;
  const std::unique_ptr<rocksdb::Iterator> row(db_->NewIterator(options, Handle(family)));
  const std::string start(std::max(prefix, after));
  row->Seek(start);
  if (!after.empty() && row->Valid() && ToView(row->key()) == after) row->Next();
  for (; row->Valid(); row->Next()) {
    ASSIGN_OR_RETURN(const bool go_on, visit(ToView(row->key()), ToView(row->value())));
    if (!go_on) return absl::OkStatus();
  }
  return FromRocksDb(row->status(), "scan the family " + std::string(FamilyName(family)));
}

absl::StatusOr<std::string> Database::LastKey(Family family) const {
  const std::unique_ptr<rocksdb::Iterator> row(
      db_->NewIterator(rocksdb::ReadOptions(), Handle(family)));
  row->SeekToLast();
  if (row->Valid()) return row->key().ToString();
  if (!row->status().ok()) return FromRocksDb(row->status(), "find the last change");
  return std::string();
}

std::unique_ptr<rocksdb::Iterator> Database::Rows(Family family,
                                                  const rocksdb::Snapshot* snapshot) const {
  rocksdb::ReadOptions options;
  options.snapshot = snapshot;
  std::unique_ptr<rocksdb::Iterator> rows(db_->NewIterator(options, Handle(family)));
  rows->SeekToFirst();
  return rows;
}

Database::Snapshot Database::TakeSnapshot() const {
  rocksdb::DB* db = db_.get();
  return {db->GetSnapshot(), [db](const rocksdb::Snapshot* taken) { db->ReleaseSnapshot(taken); }};
}

absl::Status Database::Put(Family family, std::string_view key, std::string_view value,
                           rocksdb::WriteBatch& batch) const {
  return FromRocksDb(batch.Put(Handle(family), ToSlice(key), ToSlice(value)), "build a change");
}

absl::Status Database::Delete(Family family, std::string_view key,
                              rocksdb::WriteBatch& batch) const {
  return FromRocksDb(batch.Delete(Handle(family), ToSlice(key)), "build a change");
}

absl::Status Database::DeletePrefix(Family family, std::string_view prefix,
                                    rocksdb::WriteBatch& batch) const {
  return FromRocksDb(batch.DeleteRange(Handle(family), ToSlice(prefix), EndOfPrefix(prefix)),
                     "build a change");
}

}  // namespace graspdb::storage
