// Archives: objects with their stable poses and views in one file (graspdb/v1/archive.proto).
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "files/base/atomic_file.h"
#include "graspdb/v1/archive.pb.h"

namespace graspdb::files {

// The end of an archive's name, by which commands distinguish it from a folder that does not exist.
inline constexpr std::string_view kArchiveSuffix = ".graspdb";

// The bytes of archives, for reader and writer; docs/storage-format.md describes them. The last
// byte is the version of the format.
inline constexpr std::string_view kArchiveMagic{"GAR\x01", 4};

// Before each record, little-endian: bytes of its zstd frame, and the CRC-32C of these four bytes
// and of the frame.
inline constexpr std::size_t kArchiveFrameHeaderBytes = 8;
inline constexpr std::size_t kArchiveLengthBytes = 4;

// Maximum size of a record before compression, bytes: a view of 10 million points.
inline constexpr std::size_t kMaxArchiveRecordBytes = 128U << 20;

// A record of a file.
struct ArchiveItem {
  v1::ArchiveRecord record;  // without the fields that this program does not know
  std::int64_t next = 0;     // offset of the record after it
  bool has_unknown_fields = false;
};

// An open archive. Thread-safe.
class ArchiveFile {
 public:
  // NOT_FOUND when it cannot be opened, INVALID_ARGUMENT when it is no archive, FAILED_PRECONDITION
  // when its format is newer.
  static absl::StatusOr<std::unique_ptr<ArchiveFile>> Open(const std::filesystem::path& path);
  ~ArchiveFile();
  ArchiveFile(const ArchiveFile&) = delete;
  ArchiveFile& operator=(const ArchiveFile&) = delete;

  // The record at `offset`: kFirstRecord, or the `next` of another record. DATA_LOSS, with the path
  // and the offset, when the file is truncated or damaged there. Safe on any bytes; takes memory of
  // three times kMaxArchiveRecordBytes at most.
  absl::StatusOr<ArchiveItem> ReadAt(std::int64_t offset) const;

  // DATA_LOSS with the path, the offset, and what to do.
  absl::Status Damaged(std::int64_t offset, std::string_view what) const;

  std::int64_t size() const { return size_; }
  const std::filesystem::path& path() const { return path_; }

  static constexpr std::int64_t kFirstRecord = 4;  // after the magic number

 private:
  ArchiveFile(std::filesystem::path path, int file) : path_(std::move(path)), file_(file) {}
  // `bytes` of the file from `offset`, which lie before its end.
  absl::StatusOr<std::string> Bytes(std::int64_t offset, std::size_t bytes) const;

  std::filesystem::path path_;
  int file_;
  std::int64_t size_ = 0;
};

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
