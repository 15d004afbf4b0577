// A file beside the database with an index that could be rebuilt from its records, but is faster to
// read: a header that identifies its source, and blocks. docs/storage-format.md has the bytes.
//
// The file is optional. Its reader compares the header with the current database, and rebuilds
// everything from the records if they differ or the file is incomplete.
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "storage/file_replacement.h"
#include "storage/records.pb.h"

namespace graspdb::storage {

// Name of the file in the database's directory.
inline constexpr std::string_view kIndexFile = "INDEX";

// Writes the file, which replaces the old one once it is complete. Not thread-safe; one at a time
// per directory.
class IndexFileWriter {
 public:
  // Takes exactly header.block_count() blocks.
  IndexFileWriter(const std::string& directory, const IndexHeader& header);

  // UNAVAILABLE when the disk fails; the old file stays then.
  absl::Status Append(const IndexBlock& block);
  // Returns when the file is on the disk. FAILED_PRECONDITION when blocks are missing; else as
  // Append().
  absl::Status Commit();

 private:
  absl::Status AppendPart(const std::string& bytes);

  FileReplacement file_;
  std::uint32_t checksum_;
  std::int64_t blocks_left_;
  absl::Status status_;
};

// Reads the file. DATA_LOSS for any bytes that IndexFileWriter did not write. Not thread-safe.
class IndexFileReader {
 public:
  // Reads the header. NOT_FOUND when there is no file.
  static absl::StatusOr<IndexFileReader> Open(const std::string& directory);

  const IndexHeader& header() const { return header_; }
  // The next of header().block_count() blocks.
  absl::Status Next(IndexBlock* block);
  // OK when nothing follows the last block.
  absl::Status Finish();

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  explicit IndexFileReader(std::FILE* file) : file_(file) {}
  absl::Status ReadStart();
  absl::Status ReadPart();

  std::unique_ptr<std::FILE, Close> file_;
  std::uint64_t bytes_left_ = 0;  // in the file
  std::uint32_t checksum_ = 0;
  std::string part_;
  IndexHeader header_;
};

}  // namespace graspdb::storage
