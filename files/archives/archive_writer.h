// Writes archives.
#pragma once

#include <filesystem>
#include <memory>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "files/base/atomic_file.h"
#include "graspdb/v1/archive.pb.h"

namespace graspdb::files {

// Writes one record after the other; the memory is that of a record. The same records give the same
// bytes. Not thread-safe. Errors of WriteFileAtomically.
class ArchiveWriter {
 public:
  // The file appears at `path` with Finish(), not before.
  static absl::StatusOr<ArchiveWriter> Create(const std::filesystem::path& path);

  // The order of the records is that of graspdb/v1/archive.proto; it is not checked here.
  // INVALID_ARGUMENT for a record of more than kMaxArchiveRecordBytes.
  absl::Status Add(const v1::ArchiveRecord& record);
  // After the record `end`. ALREADY_EXISTS where there is a file at the path by now, which stays.
  absl::Status Finish();

 private:
  explicit ArchiveWriter(std::unique_ptr<AtomicFile> file) : file_(std::move(file)) {}

  std::unique_ptr<AtomicFile> file_;
};

}  // namespace graspdb::files
