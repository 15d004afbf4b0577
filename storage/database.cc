#include "storage/database.h"

#include <algorithm>
#include <utility>

#include "absl/strings/escaping.h"
#include "rocksdb/cache.h"
#include "rocksdb/file_system.h"
#include "storage/rocksdb_options.h"
#include "storage/rocksdb_status.h"

namespace graspdb::storage {
namespace {

// Small, since callers cache records that they use often.
constexpr std::size_t kBlockCacheBytes = 16U << 20;
// The next start replays the logs, which takes time. Less than this is not worth a
// file for each family.
constexpr std::uint64_t kLargeLogBytes = 1U << 20;
// Between two attempts to write to a disk that was full, each of which may write the memtables.
// Doubled, writes fail for up to a second longer after there is room.
constexpr std::chrono::seconds kRecoveryInterval{1};
// For what a flush writes besides the memtables' entries: tables' indexes, manifest, log. Doubled,
// a disk that was full needs a MiB more before writes succeed.
constexpr std::uint64_t kRecoverySpareBytes = 1U << 20;

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

Database::Database(std::string directory, std::size_t write_buffer_bytes)
    : directory_(std::move(directory)),
      write_buffer_bytes_(write_buffer_bytes),
      block_cache_(rocksdb::NewLRUCache(kBlockCacheBytes)) {}

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
  // Every acknowledged write is in the synced log; an error here can lose nothing.
  FlushLargeLogs();
  for (rocksdb::ColumnFamilyHandle* handle : handles_) {
    db_->DestroyColumnFamilyHandle(handle).PermitUncheckedError();
  }
  db_->Close().PermitUncheckedError();
}

void Database::FlushLargeLogs() {
  rocksdb::VectorLogPtr logs;
  db_->GetSortedWalFiles(logs).PermitUncheckedError();
  std::uint64_t bytes = 0;
  for (const auto& log : logs) bytes += log->SizeFileBytes();
  if (bytes >= kLargeLogBytes) Flush().IgnoreError();
}

absl::Status Database::Flush() {
  // RocksDB ends all writing when it flushes with a torn log and does not recover.
  if (auto recovered = RecoverFromFullDisk(); !recovered.ok()) return recovered;
  absl::ReaderMutexLock lock(&log_mutex_);  // nothing recovers meanwhile
  const rocksdb::Status flushed = db_->Flush(rocksdb::FlushOptions(), handles_);
  if (flushed.IsNoSpace()) is_full_ = true;
  return FromRocksDb(flushed, "flush the changes");
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
    const absl::StatusOr<bool> go_on = visit(ToView(row->key()), ToView(row->value()));
    if (!go_on.ok()) return go_on.status();
    if (!*go_on) return absl::OkStatus();
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

absl::Status Database::Write(rocksdb::WriteBatch& batch) {
  if (auto recovered = RecoverFromFullDisk(); !recovered.ok()) return recovered;
  absl::ReaderMutexLock lock(&log_mutex_);
  const rocksdb::Status written = WriteToLog(batch);
  if (written.IsNoSpace()) is_full_ = true;
  return FromRocksDb(written, "write the change");
}

rocksdb::Status Database::WriteToLog(rocksdb::WriteBatch& batch) {
  // A new log begins when memtables with entries are flushed. Without an entry, a log that found
  // the disk full could not be replaced, and RocksDB 7.8 ends the process at the next write. Every
  // time, since RocksDB replaces full memtables at the beginning of a write; another writer can
  // still fill one between these two.
  rocksdb::WriteOptions unlogged;
  unlogged.disableWAL = true;
  rocksdb::Status marked = db_->Delete(unlogged, Handle(Family::kMeta), "no such row");
  if (!marked.ok()) return marked;
  rocksdb::WriteOptions options;
  options.sync = true;
  return db_->Write(options, &batch);
}

absl::Status Database::RecoverFromFullDisk() {
  if (!is_full_) return absl::OkStatus();
  absl::MutexLock lock(&log_mutex_);
  if (!is_full_) return absl::OkStatus();
  const rocksdb::Status full = rocksdb::Status::NoSpace("the disk is full");
  const auto now = std::chrono::steady_clock::now();
  if (now < next_recovery_) return FromRocksDb(full, "write the change");
  next_recovery_ = now + kRecoveryInterval;
  // The log may end in a part of a write, and RocksDB does not write behind that any more.
  // Everything in the memtables goes to sorted files, and a new log begins.
  rocksdb::Status recovered = Resume();
  // CheckLogs() takes a torn log beside a newer one for damage; a backup keeps what it copies.
  rocksdb::VectorLogPtr logs;
  if (recovered.ok()) recovered = db_->GetSortedWalFiles(logs);
  is_full_ = !recovered.ok() || logs.size() > 1;
  const bool waits = recovered.IsBusy() || (recovered.ok() && is_full_);
  return FromRocksDb(waits ? full : recovered, "write the change");
}

bool Database::HasRoomForMemtables() const {
  std::uint64_t memtables = 0;
  db_->GetAggregatedIntProperty(rocksdb::DB::Properties::kCurSizeAllMemTables, &memtables);
  std::uint64_t room = 0;
  const rocksdb::IOStatus measured =
      db_->GetFileSystem()->GetFreeSpace(directory_, rocksdb::IOOptions(), &room, nullptr);
  return !measured.ok() || room >= memtables + kRecoverySpareBytes;
}

// DB::Resume() flushes all memtables. In RocksDB 7.8 with atomic_flush a flush that another one has
// made fail is never repeated, and DB::Resume() waits for it; or it syncs the torn log, where an
// assertion ends the process (https://github.com/facebook/rocksdb/pull/11872). So none may fail
// meanwhile: there must be room for all memtables, and none may be running already.
rocksdb::Status Database::Resume() {
  if (!HasRoomForMemtables()) return rocksdb::Status::NoSpace();
  // Pausing waits for running flushes and compactions, and after an error no other begins.
  rocksdb::Status idle = db_->PauseBackgroundWork();
  if (idle.ok()) idle = db_->ContinueBackgroundWork();
  if (!idle.ok()) return idle;
  if (!HasRoomForMemtables()) return rocksdb::Status::NoSpace();  // a compaction has taken it
  for (rocksdb::ColumnFamilyHandle* family : handles_) {
    std::uint64_t immutable = 0;
    std::uint64_t pending = 0;
    db_->GetIntProperty(family, rocksdb::DB::Properties::kNumImmutableMemTable, &immutable);
    db_->GetIntProperty(family, rocksdb::DB::Properties::kMemTableFlushPending, &pending);
    if (immutable > 0 && pending == 0) {
      return rocksdb::Status::IOError("a flush that failed cannot be repeated");
    }
  }
  const rocksdb::Status resumed = db_->Resume();
  // Where a new log could not be made, RocksDB takes the full disk for an error that it never ends.
  const bool is_final = resumed.severity() >= rocksdb::Status::Severity::kFatalError;
  return is_final ? rocksdb::Status::IOError(resumed.ToString()) : resumed;
}

}  // namespace graspdb::storage
