// Atomic writes of files.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace graspdb::files {

// Whether a file must survive a power failure right after it was written. Waiting
// for the disk takes milliseconds, on a busy one far longer.
enum class Durability {
  kProcessCrash,
  // The bytes do, the name after FlushNames() of a folder that MakeDurableFolder() made: many files
  // wait for their names once.
  kBytes,
  kPowerFailure,
};

// What is done with a file that is at the path already.
enum class Existing { kReplace, kKeep };

// A file that is written in parts, beside its path, and appears there as a whole. Its errors are
// those of WriteFileAtomically. Not thread-safe.
class AtomicFile {
 public:
  // Missing folders are created. With kPowerFailure their names, or that of the folder that is
  // there already, are on the disk when this returns, and that of the file when Commit() does,
  // where the file system can do that and the folder above may be read, not only written.
  static absl::StatusOr<std::unique_ptr<AtomicFile>> Create(const std::filesystem::path& path,
                                                            Durability durability);
  // Removes what was written, unless it was committed.
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  absl::Status Append(std::string_view bytes);
  // Once, after the last Append(). With kKeep, ALREADY_EXISTS where there is a file at the path,
  // also if it appeared just now; only on file systems without hard links and renameat2(2), a file
  // that appears within this call is replaced.
  absl::Status Commit(Existing existing = Existing::kReplace);

 private:
  AtomicFile(std::filesystem::path path, Durability durability, std::string temporary, int file);

  std::filesystem::path path_;
  Durability durability_;
  std::string temporary_;  // empty: committed
  int file_;               // -1: closed
};

// Writes `bytes` beside `path` and renames the result to `path`, replacing an
// existing file; missing folders are created. A reader sees the old file or the new
// one, never a part; with kPowerFailure also after the machine stopped. Two
// writers of one path must not run at the same time. A link in place of what is
// written beside `path` is not followed.
//
// PERMISSION_DENIED, RESOURCE_EXHAUSTED (disk full) or FAILED_PRECONDITION (any
// other failure), with the path; a file at `path` is then unchanged, unless only its folder could
// not be flushed.
absl::Status WriteFileAtomically(const std::filesystem::path& path, std::string_view bytes,
                                 Durability durability);

// Makes `folder` and the missing ones above it; they are on the disk when it returns, as far as
// AtomicFile::Create() puts them there. Errors of WriteFileAtomically. Thread-safe.
absl::Status MakeDurableFolder(const std::filesystem::path& folder);

// Returns when the names of the files in `folder` are on the disk, where it may be read and the
// file system can do that. PERMISSION_DENIED, RESOURCE_EXHAUSTED or FAILED_PRECONDITION, with the
// path; the files are there even so. Thread-safe.
absl::Status FlushNames(const std::filesystem::path& folder);

}  // namespace graspdb::files
