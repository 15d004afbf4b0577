// Archives. Checksums are corrected before an input is read, so that the records after them are
// parsed; records that are no zstd frame are packed.
#include <zstd.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "files/archives/archive_file.h"
#include "files/archives/archive_index.h"
#include "storage/base/crc32c.h"
#include "storage/base/little_endian.h"
#include "tests/fuzz/bytes_target.h"
#include "tests/fuzz/requirement.h"
#include "tests/fuzz/scratch_folder.h"

namespace graspdb::fuzz {
namespace {

constexpr std::size_t kMagicBytes = 4;
constexpr std::size_t kFrameHeaderBytes = 8;

// The record, as it is if it is a frame of zstd, else as a frame.
std::string Packed(std::string_view record) {
  if (record.starts_with("\x28\xb5\x2f\xfd")) return std::string(record);
  std::string frame(ZSTD_compressBound(record.size()), '\0');
  frame.resize(ZSTD_compress(frame.data(), frame.size(), record.data(), record.size(), 1));
  return frame;
}

// The input's records with right checksums. A length beyond the end stays as it is.
std::string Corrected(std::string_view bytes) {
  std::string out(bytes.substr(0, kMagicBytes));
  bytes.remove_prefix(out.size());
  while (bytes.size() > kFrameHeaderBytes) {
    const std::size_t size = storage::FromLittleEndian(bytes.substr(0, 4));
    if (size > bytes.size() - kFrameHeaderBytes) break;
    const std::string frame = Packed(bytes.substr(kFrameHeaderBytes, size));
    const std::string length = storage::ToLittleEndian(static_cast<std::uint32_t>(frame.size()));
    out += length;
    out += storage::ToLittleEndian(storage::Crc32c(frame, storage::Crc32c(length)));
    out += frame;
    bytes.remove_prefix(kFrameHeaderBytes + size);
  }
  return out.append(bytes);
}

void Read(std::string_view bytes) {
  static const ScratchFolder folder;
  const auto file = files::ArchiveFile::Open(folder.Write("in.graspdb", Corrected(bytes)));
  if (!file.ok()) return;
  const auto index = files::IndexArchive(**file, nullptr);
  if (!index.ok()) return;
  const std::filesystem::path copy = folder.path() / "out.graspdb";
  std::filesystem::remove(copy);
  auto writer = files::ArchiveWriter::Create(copy);
  Require(writer.ok(), "a copy can be begun");
  for (std::int64_t at = files::ArchiveFile::kFirstRecord; at < (*file)->size();) {
    const auto item = (*file)->ReadAt(at);
    Require(item.ok(), "an indexed record can be read again");
    Require(writer->Add(item->record).ok(), "and written");
    at = item->next;
  }
  Require(writer->Finish().ok(), "a copy can be finished");
  const auto again = files::ArchiveFile::Open(copy);
  Require(again.ok(), "a copy can be opened");
  const auto same = files::IndexArchive(**again, nullptr);
  Require(same.ok() && same->digest == index->digest, "a copy has the same content");
  Require(same->entries.size() == index->entries.size(), "a copy has the same records");
}

}  // namespace
}  // namespace graspdb::fuzz

GRASPDB_FUZZ_BYTES(graspdb::fuzz::Read)
