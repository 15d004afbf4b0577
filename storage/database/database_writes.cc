// Writing of the database, and what becomes of it when the disk is full or fails.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <utility>

#include "absl/time/clock.h"
#include "base/status_macros.h"
#include "rocksdb/file_system.h"
#include "storage/database/database.h"
#include "storage/database/rocksdb_status.h"

namespace graspdb::storage {
namespace {

using Clock = std::chrono::steady_clock;

// The next start replays the logs, which takes time. Less than this is not worth a
// file for each family.
constexpr std::uint64_t kLargeLogBytes = 1U << 20;
// Between two attempts to write to a disk that was full. Each may write the memtables.
constexpr std::chrono::seconds kRecoveryInterval{1};
// The longest time between two attempts after the disk failed.
constexpr std::chrono::seconds kMaxRecoveryInterval{30};
// Between two attempts to write a small file while nothing has failed.
constexpr std::chrono::seconds kProbeInterval{30};
// File descriptors for a flush: sorted files of the families, clouds, manifest, log, folders.
constexpr int kFlushDescriptors = 32;
// Of a write buffer. RocksDB replaces a memtable from 95 % on, in steps of an eighth.
constexpr double kFullShare = 0.75;
constexpr char kProbeFile[] = "/WRITE_PROBE";

// Whether a flush gets its file descriptors.
rocksdb::Status ProbeDescriptors() {
  std::array<int, kFlushDescriptors> files{};
  bool enough = true;
  for (int& file : files) {
    file = open("/dev/null", O_RDONLY | O_CLOEXEC);
    enough = enough && file >= 0;
  }
  for (const int file : files) {
    if (file >= 0) close(file);
  }
  return enough ? rocksdb::Status::OK()
                : rocksdb::Status::IOError("too few free file descriptors (ulimit -n)");
}

// The code of `error` and its text, which says what to do.
absl::Status Rejecting(const absl::Status& error) {
  return {error.ok() ? absl::StatusCode::kUnavailable : error.code(),  // never as if written
          "changes are rejected since a write failed: " + std::string(error.message())};
}

}  // namespace

void Database::FlushLargeLogs() {
  rocksdb::VectorLogPtr logs;
  db_->GetSortedWalFiles(logs).PermitUncheckedError();
  std::uint64_t bytes = 0;
  for (const auto& log : logs) bytes += log->SizeFileBytes();
  if (bytes >= kLargeLogBytes) Flush().IgnoreError();
}

absl::Status Database::Flush() {
  PrepareToFree(0);  // it deletes logs
  return FlushPrepared();
}

absl::Status Database::FlushPrepared() {
  // RocksDB ends all writing when it flushes with a torn log and does not recover.
  RETURN_IF_ERROR(Recover());
  absl::ReaderMutexLock lock(&log_mutex_);  // nothing recovers meanwhile
  rocksdb::Status flushed = ProbeFlush();
  if (flushed.ok()) flushed = db_->Flush(rocksdb::FlushOptions(), handles_);
  return flushed.ok() ? absl::OkStatus() : Failed(flushed);
}

absl::Status Database::Write(rocksdb::WriteBatch& batch, WritePurpose purpose) {
  if (purpose == WritePurpose::kFree) {
    PrepareToFree(batch.GetDataSize());
  } else {
    RETURN_IF_ERROR(CheckRoomToAdd());
  }
  RETURN_IF_ERROR(Recover());
  absl::ReaderMutexLock lock(&log_mutex_);
  rocksdb::Status written = ReplaceFullMemtables();
  if (written.ok()) written = WriteToLog(batch);
  return written.ok() ? absl::OkStatus() : Failed(written);
}

bool Database::IsMemtableFull() const {
  return std::ranges::any_of(handles_, [this](rocksdb::ColumnFamilyHandle* family) {
    std::uint64_t bytes = 0;
    db_->GetIntProperty(family, rocksdb::DB::Properties::kCurSizeActiveMemTable, &bytes);
    return static_cast<double>(bytes) >= kFullShare * static_cast<double>(write_buffer_bytes_);
  });
}

// Before RocksDB does, at the beginning of a write: where the new log cannot be made then, it has
// an error, and in 7.8 with atomic_flush it ends the process when it is closed. So new files are
// tried first. The flush goes on in the background.
rocksdb::Status Database::ReplaceFullMemtables() {
  if (!IsMemtableFull()) return rocksdb::Status::OK();
  absl::MutexLock lock(&replacement_mutex_);
  if (!IsMemtableFull()) return rocksdb::Status::OK();  // another writer did it
  if (rocksdb::Status probed = ProbeFlush(); !probed.ok()) return probed;
  rocksdb::FlushOptions in_background;
  in_background.wait = false;
  in_background.allow_write_stall = true;
  return db_->Flush(in_background, handles_);
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

absl::Status Database::Failed(const rocksdb::Status& status) {
  absl::Status error = FromRocksDbWrite(status);
  SetFailure(error);
  return error;
}

void Database::SetFailure(absl::Status error) {
  absl::MutexLock lock(&fault_mutex_);
  is_failing_ = !error.ok();
  SetFault(std::move(error));
}

void Database::NoteFault(absl::Status error) {
  absl::MutexLock lock(&fault_mutex_);
  if (!is_failing_) SetFault(std::move(error));
}

void Database::SetFault(absl::Status error) {
  if (fault_.error.ok() && !error.ok()) fault_.begin = absl::Now();
  fault_.error = std::move(error);
}

WriteFault Database::write_fault() const {
  absl::MutexLock lock(&fault_mutex_);
  return fault_;
}

absl::Status Database::Recover() {
  if (!is_failing_) return absl::OkStatus();
  absl::MutexLock lock(&log_mutex_);
  if (!is_failing_) return absl::OkStatus();
  const Clock::time_point now = Clock::now();
  if (now < next_recovery_) return Rejecting(write_fault().error);
  const rocksdb::Status recovered = RecoverLocked();
  if (recovered.ok()) {
    recovery_interval_ = Clock::duration::zero();
    SetFailure(absl::OkStatus());
    return absl::OkStatus();
  }
  const bool waits = recovered.IsNoSpace() || recovered.IsBusy();
  recovery_interval_ = waits ? kRecoveryInterval
                             : std::clamp<Clock::duration>(2 * recovery_interval_,
                                                           kRecoveryInterval, kMaxRecoveryInterval);
  next_recovery_ = now + recovery_interval_;
  absl::Status error = FromRocksDbWrite(recovered);
  SetFailure(error);
  return Rejecting(error);
}

// The log may end in a part of a write, and RocksDB does not write behind that any more. Everything
// in the memtables goes to sorted files, and a new log begins.
rocksdb::Status Database::RecoverLocked() {
  rocksdb::Status recovered = ProbeFlush();
  if (recovered.ok()) recovered = Resume();
  // CheckLogs() takes a torn log beside a newer one for damage; a backup keeps what it copies.
  rocksdb::VectorLogPtr logs;
  if (recovered.ok()) recovered = db_->GetSortedWalFiles(logs);
  const bool waits = recovered.IsBusy() || (recovered.ok() && logs.size() > 1);
  return waits ? rocksdb::Status::NoSpace("the disk is full") : recovered;
}

rocksdb::Status Database::ProbeFlush() const {
  const std::uint64_t bytes = RoomForFlush();
  if (!HasRoom(bytes)) return rocksdb::Status::NoSpace("the disk is full");
  const rocksdb::Status files = ProbeDescriptors();
  return files.ok() ? ProbeFolder(bytes) : files;
}

rocksdb::Status Database::ProbeFolder(std::uint64_t bytes) const {
  // Files beside those of another file system would be lost with the next mount.
  if (FolderIdOf(directory_) != folder_) {
    return rocksdb::Status::IOError("another folder is in the place of " + directory_ +
                                    " since it was opened");
  }
  const std::string path = directory_ + kProbeFile;
  rocksdb::FileSystem& files = *db_->GetFileSystem();
  std::unique_ptr<rocksdb::FSWritableFile> file;
  const rocksdb::IOOptions options;
  rocksdb::IOStatus done = files.NewWritableFile(path, rocksdb::FileOptions(), &file, nullptr);
  if (done.ok()) {
    // Also fails where the limit of a file's size is too low (ulimit -f).
    if (bytes > 0) done = file->Allocate(0, bytes, options, nullptr);
    if (done.IsNotSupported()) done = rocksdb::IOStatus::OK();
    if (done.ok()) done = file->Append("a database can be written here\n", options, nullptr);
    if (done.ok()) done = file->Fsync(options, nullptr);
    const rocksdb::IOStatus closed = file->Close(options, nullptr);
    if (done.ok()) done = closed;
  }
  files.DeleteFile(path, options, nullptr).PermitUncheckedError();  // as of an earlier process
  return done;
}

rocksdb::Status Database::CheckFlushesRepeatable() const {
  for (rocksdb::ColumnFamilyHandle* family : handles_) {
    std::uint64_t immutable = 0;
    std::uint64_t pending = 0;
    db_->GetIntProperty(family, rocksdb::DB::Properties::kNumImmutableMemTable, &immutable);
    db_->GetIntProperty(family, rocksdb::DB::Properties::kMemTableFlushPending, &pending);
    if (immutable > 0 && pending == 0) {
      return rocksdb::Status::IOError("a flush that failed cannot be repeated");
    }
  }
  return rocksdb::Status::OK();
}

// DB::Resume() flushes all memtables. In RocksDB 7.8 with atomic_flush a flush that another one has
// made fail is never repeated, and DB::Resume() waits for it; or it syncs the torn log, where an
// assertion ends the process (https://github.com/facebook/rocksdb/pull/11872). So none may fail
// meanwhile: there must be room for all memtables, and none may be running already.
rocksdb::Status Database::Resume() {
  // Pausing waits for running flushes and compactions, and after an error no other begins.
  rocksdb::Status idle = db_->PauseBackgroundWork();
  if (idle.ok()) idle = db_->ContinueBackgroundWork();
  if (!idle.ok()) return idle;
  // A compaction has taken it.
  if (!HasRoom(RoomForFlush())) return rocksdb::Status::NoSpace("the disk is full");
  const rocksdb::Status repeatable = CheckFlushesRepeatable();
  return repeatable.ok() ? db_->Resume() : repeatable;
}

void Database::CheckWrites(std::atomic<bool>* cancelled) {
  TakeReserve();
  CompactForRoom(cancelled);
  if (is_failing_) {
    Recover().IgnoreError();  // the fault has it
    return;
  }
  const Clock::time_point now = Clock::now();
  if (now >= next_probe_) {
    MakeReserve();
    // An empty write of no log: fails where a flush in the background has failed.
    rocksdb::WriteOptions unlogged;
    unlogged.disableWAL = true;
    rocksdb::WriteBatch empty;
    if (const rocksdb::Status state = db_->Write(unlogged, &empty); !state.ok()) {
      Failed(state).IgnoreError();
      return;
    }
    probed_ = ProbeDescriptors();
    if (probed_.ok()) probed_ = ProbeFolder(0);
    next_probe_ = now + (probed_.ok() ? kProbeInterval : kRecoveryInterval);
  }
  const absl::Status room = CheckRoomToAdd();
  NoteFault(probed_.ok() ? room : FromRocksDbWrite(probed_));
}

}  // namespace graspdb::storage
