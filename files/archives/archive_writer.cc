#include "files/archives/archive_writer.h"

#include <zstd.h>

#include <cstdint>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "files/archives/archive_file.h"
#include "storage/base/crc32c.h"
#include "storage/base/little_endian.h"

namespace graspdb::files {
namespace {

// zstd's default: higher levels take several times as long and save some per cent of a cloud.
constexpr int kArchiveLevel = 3;

}  // namespace

absl::StatusOr<ArchiveWriter> ArchiveWriter::Create(const std::filesystem::path& path) {
  ASSIGN_OR_RETURN(auto file, AtomicFile::Create(path, Durability::kPowerFailure));
  RETURN_IF_ERROR(file->Append(kArchiveMagic));
  return ArchiveWriter(std::move(file));
}

absl::Status ArchiveWriter::Add(const v1::ArchiveRecord& record) {
  const std::string raw = record.SerializeAsString();
  if (raw.size() > kMaxArchiveRecordBytes) {
    return absl::InvalidArgumentError(absl::StrCat("a record of ", raw.size(),
                                                   " bytes does not fit into an archive, which "
                                                   "takes ",
                                                   kMaxArchiveRecordBytes, " a record"));
  }
  std::string frame(ZSTD_compressBound(raw.size()), '\0');
  const std::size_t size =
      ZSTD_compress(frame.data(), frame.size(), raw.data(), raw.size(), kArchiveLevel);
  if (ZSTD_isError(size) != 0) {
    return absl::InternalError(
        absl::StrCat("zstd cannot pack a record: ", ZSTD_getErrorName(size)));
  }
  frame.resize(size);
  std::string header = storage::ToLittleEndian(static_cast<std::uint32_t>(size));
  header += storage::ToLittleEndian(storage::Crc32c(frame, storage::Crc32c(header)));
  RETURN_IF_ERROR(file_->Append(header));
  return file_->Append(frame);
}

absl::Status ArchiveWriter::Finish() { return file_->Commit(Existing::kKeep); }

}  // namespace graspdb::files
