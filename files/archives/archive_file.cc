#include "files/archives/archive_file.h"

#include <fcntl.h>
#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/wire_format_lite.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zstd.h>

#include <cerrno>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "storage/base/crc32c.h"
#include "storage/base/little_endian.h"

namespace graspdb::files {
namespace {

// Maximum bytes of a record beside the points of a view: a stable pose with all of its grasps has
// some 20 kB. Two bytes may become a message of 110 in memory, so that a hostile record takes some
// 60 MB.
constexpr std::size_t kMaxBytesBesidePoints = 1U << 20;

absl::Status NoArchive(const std::filesystem::path& path) {
  return absl::InvalidArgumentError(
      absl::StrCat(path.string(), " is not an archive; give a file that `graspdb export FILE",
                   std::string(kArchiveSuffix), "` made, or the folder of a capture set"));
}

// The content of a zstd frame of a size within the limit; empty otherwise.
std::string Unpack(std::string_view frame) {
  const unsigned long long raw_size = ZSTD_getFrameContentSize(frame.data(), frame.size());
  if (raw_size == ZSTD_CONTENTSIZE_ERROR || raw_size == ZSTD_CONTENTSIZE_UNKNOWN ||
      raw_size > kMaxArchiveRecordBytes) {
    return {};
  }
  std::string raw(raw_size, '\0');
  const std::size_t size = ZSTD_decompress(raw.data(), raw.size(), frame.data(), frame.size());
  if (ZSTD_isError(size) != 0 || size != raw.size()) return {};
  return raw;
}

// The content of a message's first field of that number, a message or bytes; empty without one.
std::string_view FirstField(std::string_view message, int number) {
  using Wire = google::protobuf::internal::WireFormatLite;
  google::protobuf::io::CodedInputStream in(reinterpret_cast<const std::uint8_t*>(message.data()),
                                            static_cast<int>(message.size()));
  const std::uint32_t wanted = Wire::MakeTag(number, Wire::WIRETYPE_LENGTH_DELIMITED);
  for (std::uint32_t tag = in.ReadTag(); tag != wanted; tag = in.ReadTag()) {
    if (tag == 0 || !Wire::SkipField(&in, tag)) return {};
  }
  std::uint32_t size = 0;
  if (!in.ReadVarint32(&size)) return {};
  const auto at = static_cast<std::size_t>(in.CurrentPosition());
  return size <= message.size() - at ? message.substr(at, size) : std::string_view();
}

std::size_t BytesBesidePoints(std::string_view record) {
  const std::string_view view = FirstField(record, v1::ArchiveRecord::kViewFieldNumber);
  const std::string_view cloud = FirstField(view, v1::View::kCloudFieldNumber);
  return record.size() - FirstField(cloud, v1::PointCloud::kDataFieldNumber).size();
}

// zstd's default: higher levels take several times as long and save some per cent of a cloud.
constexpr int kArchiveLevel = 3;

}  // namespace

static_assert(ArchiveFile::kFirstRecord == kArchiveMagic.size());

ArchiveFile::~ArchiveFile() { close(file_); }

absl::Status ArchiveFile::Damaged(std::int64_t offset, std::string_view what) const {
  return absl::DataLossError(absl::StrCat(path_.string(), " is damaged at byte ", offset, ": ",
                                          std::string(what),
                                          "; copy the file again, or export it again"));
}

absl::StatusOr<std::unique_ptr<ArchiveFile>> ArchiveFile::Open(const std::filesystem::path& path) {
  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) {
    return absl::NotFoundError(absl::StrCat("cannot read ", path.string(), ": ",
                                            std::generic_category().message(errno),
                                            "; check the path and its permissions"));
  }
  std::unique_ptr<ArchiveFile> out(new ArchiveFile(path, descriptor));
  struct stat state {};
  if (fstat(descriptor, &state) != 0 || !S_ISREG(state.st_mode)) return NoArchive(path);
  out->size_ = state.st_size;
  if (out->size_ < kFirstRecord) return NoArchive(path);
  ASSIGN_OR_RETURN(const std::string magic, out->Bytes(0, kArchiveMagic.size()));
  if (magic == kArchiveMagic) return out;
  if (magic.substr(0, kArchiveMagic.size() - 1) !=
      kArchiveMagic.substr(0, kArchiveMagic.size() - 1)) {
    return NoArchive(path);
  }
  return absl::FailedPreconditionError(
      absl::StrCat(path.string(), " has format ", static_cast<unsigned char>(magic.back()),
                   ", and this version reads ", static_cast<int>(kArchiveMagic.back()),
                   "; use the version that wrote it, or a later one"));
}

absl::StatusOr<std::string> ArchiveFile::Bytes(std::int64_t offset, std::size_t bytes) const {
  std::string out(bytes, '\0');
  std::size_t done = 0;
  while (done < bytes) {
    const ssize_t count =
        pread(file_, out.data() + done, bytes - done, offset + static_cast<std::int64_t>(done));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      return absl::DataLossError(absl::StrCat("cannot read ", path_.string(), " at byte ", offset,
                                              ": ", std::generic_category().message(errno),
                                              "; check the disk"));
    }
    if (count == 0) return Damaged(offset, "it was cut off while it was read");
    done += static_cast<std::size_t>(count);
  }
  return out;
}

absl::StatusOr<ArchiveItem> ArchiveFile::ReadAt(std::int64_t offset) const {
  constexpr std::int64_t kHeader = kArchiveFrameHeaderBytes;
  if (offset < kFirstRecord || offset > size_ - kHeader) {
    return Damaged(offset, "it ends where a record should follow");
  }
  ASSIGN_OR_RETURN(const std::string header, Bytes(offset, kArchiveFrameHeaderBytes));
  const std::string_view length = std::string_view(header).substr(0, kArchiveLengthBytes);
  const std::int64_t bytes = storage::FromLittleEndian(length);
  if (bytes > size_ - kHeader - offset) return Damaged(offset, "it ends within a record");
  if (bytes > std::int64_t{kMaxArchiveRecordBytes}) return Damaged(offset, "a record is too large");
  ASSIGN_OR_RETURN(const std::string frame,
                   Bytes(offset + kHeader, static_cast<std::size_t>(bytes)));
  const std::string_view checksum = std::string_view(header).substr(kArchiveLengthBytes);
  if (storage::Crc32c(frame, storage::Crc32c(length)) != storage::FromLittleEndian(checksum)) {
    return Damaged(offset, "a checksum does not match");
  }
  // The checksum detects accidents; the checks below also detect malice.
  const std::string raw = Unpack(frame);
  if (BytesBesidePoints(raw) > kMaxBytesBesidePoints) {
    return Damaged(offset, "a record is too large");
  }
  ArchiveItem out;
  if (raw.empty() || !out.record.ParseFromString(raw)) {
    return Damaged(offset, "a record cannot be unpacked");
  }
  const std::size_t size = out.record.ByteSizeLong();
  out.record.DiscardUnknownFields();
  out.has_unknown_fields = out.record.ByteSizeLong() != size;
  out.next = offset + kHeader + bytes;
  return out;
}

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
