// What an archive has, and where.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "files/archives/archive_file.h"

namespace graspdb::files {

enum class ArchiveKind : std::uint8_t { kObject, kStablePose, kView };

// A record of an archive.
struct ArchiveEntry {
  ArchiveKind kind = ArchiveKind::kObject;
  std::int64_t offset = 0;  // ArchiveFile::ReadAt()
  std::string name;         // resource name
};

// Some 150 bytes for a record.
struct ArchiveIndex {
  // Each object, then its stable poses, each with its views after it.
  std::vector<ArchiveEntry> entries;
  // The same for files of the same content: 16 hexadecimal digits.
  std::string digest;
  // Whether a newer program wrote fields that this one does not know.
  bool has_unknown_fields = false;
};

// The number of read bytes; an error of its own ends the reading.
using OnArchiveBytes = std::function<absl::Status(std::int64_t)>;

// Reads and checks the whole file: checksums, order, valid and unique names, views with both poses
// and a cloud of packed floats, counts, and nothing after the end. DATA_LOSS with the offset.
absl::StatusOr<ArchiveIndex> IndexArchive(const ArchiveFile& file, const OnArchiveBytes& on_bytes);

}  // namespace graspdb::files
