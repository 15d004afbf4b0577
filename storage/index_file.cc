#include "storage/index_file.h"

#include <array>
#include <cerrno>
#include <filesystem>
#include <system_error>

#include "storage/crc32c.h"
#include "storage/little_endian.h"

namespace graspdb::storage {
namespace {

// The last byte is the version of the layout.
constexpr std::string_view kIndexMagic("GIX\x01", 4);

std::string IndexPath(const std::string& directory) {
  return directory + "/" + std::string(kIndexFile);
}

absl::Status DamagedIndex(std::string_view what) {
  return absl::DataLossError("the index file is damaged (" + std::string(what) + ")");
}

}  // namespace

IndexFileWriter::IndexFileWriter(const std::string& directory, const IndexHeader& header)
    : file_(IndexPath(directory)),
      checksum_(Crc32c(kIndexMagic)),
      blocks_left_(header.block_count()) {
  status_ = file_.Append(kIndexMagic);
  status_.Update(AppendPart(header.SerializeAsString()));
}

absl::Status IndexFileWriter::AppendPart(const std::string& bytes) {
  // Chained, to detect parts at another place or from another file.
  checksum_ = Crc32c(bytes, checksum_);
  const auto size = static_cast<std::uint32_t>(bytes.size());
  status_.Update(file_.Append(ToLittleEndian(size) + ToLittleEndian(checksum_)));
  status_.Update(file_.Append(bytes));
  return status_;
}

absl::Status IndexFileWriter::Append(const IndexBlock& block) {
  --blocks_left_;
  return AppendPart(block.SerializeAsString());
}

absl::Status IndexFileWriter::Commit() {
  if (!status_.ok()) return status_;
  if (blocks_left_ == 0) return file_.Commit();
  return absl::FailedPreconditionError(
      "the number of blocks of the index file differs from its header");
}

absl::StatusOr<IndexFileReader> IndexFileReader::Open(const std::string& directory) {
  const std::string path = IndexPath(directory);
  std::FILE* file = std::fopen(path.c_str(), "rbe");
  if (file == nullptr && errno == ENOENT) return absl::NotFoundError("there is no index file");
  if (file == nullptr) return DamagedIndex("it cannot be opened");
  IndexFileReader out(file);
  std::error_code error;
  out.bytes_left_ = std::filesystem::file_size(path, error);
  if (error) return DamagedIndex("it cannot be read");
  if (absl::Status status = out.ReadStart(); !status.ok()) return status;
  return out;
}

absl::Status IndexFileReader::ReadStart() {
  std::array<char, kIndexMagic.size()> magic{};
  const std::size_t read = std::fread(magic.data(), 1, magic.size(), file_.get());
  if (std::string_view(magic.data(), read) != kIndexMagic)
    return DamagedIndex("it has an unknown format");
  bytes_left_ -= read;
  checksum_ = Crc32c(kIndexMagic);
  if (absl::Status status = ReadPart(); !status.ok()) return status;
  return header_.ParseFromString(part_) ? absl::OkStatus() : DamagedIndex("its header");
}

absl::Status IndexFileReader::ReadPart() {
  std::array<char, 2 * kUint32Bytes> start{};
  if (bytes_left_ < start.size() ||
      std::fread(start.data(), 1, start.size(), file_.get()) != start.size()) {
    return DamagedIndex("its end is missing");
  }
  bytes_left_ -= start.size();
  const std::uint32_t size = FromLittleEndian({start.data(), kUint32Bytes});
  const std::uint32_t checksum = FromLittleEndian({start.data() + kUint32Bytes, kUint32Bytes});
  if (size > bytes_left_) return DamagedIndex("its end is missing");
  part_.resize(size);
  if (std::fread(part_.data(), 1, size, file_.get()) != size)
    return DamagedIndex("it cannot be read");
  bytes_left_ -= size;
  checksum_ = Crc32c(part_, checksum_);
  return checksum_ == checksum ? absl::OkStatus() : DamagedIndex("a checksum is wrong");
}

absl::Status IndexFileReader::Next(IndexBlock* block) {
  if (absl::Status status = ReadPart(); !status.ok()) return status;
  return block->ParseFromString(part_) ? absl::OkStatus() : DamagedIndex("a block");
}

absl::Status IndexFileReader::Finish() {
  return bytes_left_ == 0 ? absl::OkStatus() : DamagedIndex("there are bytes after its end");
}

}  // namespace graspdb::storage
