#include "storage/database/approximate_file.h"

#include "storage/base/crc32c.h"
#include "storage/base/little_endian.h"
#include "storage/base/whole_file.h"

namespace graspdb::storage {
namespace {

// The last byte is the version of the layout; the checksum and the record follow.
constexpr std::string_view kApproximateMagic("GAX\x01", 4);
constexpr std::size_t kStartBytes = kApproximateMagic.size() + kUint32Bytes;

std::string ApproximatePath(const std::string& directory) {
  return directory + "/" + std::string(kApproximateFile);
}

std::string StartOf(std::string_view record) {
  return std::string(kApproximateMagic) + ToLittleEndian(Crc32c(record, Crc32c(kApproximateMagic)));
}

absl::Status DamagedApproximate() {
  return absl::DataLossError("the approximate index file is damaged");
}

}  // namespace

absl::Status WriteApproximateFile(const std::string& directory,
                                  const ApproximateIndexRecord& record) {
  std::string bytes(kStartBytes, '\0');
  if (!record.AppendToString(&bytes)) {
    return absl::UnavailableError("the approximate index is too large for its file");
  }
  bytes.replace(0, kStartBytes, StartOf(std::string_view(bytes).substr(kStartBytes)));
  return ReplaceFile(ApproximatePath(directory), bytes);
}

absl::StatusOr<ApproximateIndexRecord> ReadApproximateFile(const std::string& directory) {
  const absl::StatusOr<std::string> bytes = ReadWholeFile(ApproximatePath(directory));
  if (absl::IsNotFound(bytes.status())) {
    return absl::NotFoundError("there is no approximate index file");
  }
  if (!bytes.ok()) return bytes.status();
  if (bytes->size() < kStartBytes) return DamagedApproximate();
  const std::string_view record = std::string_view(*bytes).substr(kStartBytes);
  if (bytes->substr(0, kStartBytes) != StartOf(record)) return DamagedApproximate();
  ApproximateIndexRecord out;
  if (!out.ParseFromArray(record.data(), static_cast<int>(record.size())))
    return DamagedApproximate();
  return out;
}

}  // namespace graspdb::storage
