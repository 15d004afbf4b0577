#include "storage/database/revision_floor.h"

#include "absl/strings/numbers.h"
#include "storage/base/crc32c.h"
#include "storage/base/restore_advice.h"
#include "storage/base/whole_file.h"

namespace graspdb::storage {
namespace {

std::string FloorPath(const std::string& directory) {
  return directory + "/" + std::string(kRevisionFloorFile);
}

// The revision and the checksum of its digits: "12 2869459284\n".
std::string Encode(std::int64_t revision) {
  const std::string digits = std::to_string(revision);
  return digits + " " + std::to_string(Crc32c(digits)) + "\n";
}

}  // namespace

absl::Status WriteRevisionFloor(const std::string& directory, std::int64_t revision) {
  return ReplaceFile(FloorPath(directory), Encode(revision));
}

absl::StatusOr<std::optional<std::int64_t>> ReadRevisionFloor(const std::string& directory) {
  const std::string path = FloorPath(directory);
  const absl::StatusOr<std::string> text = ReadWholeFile(path);
  if (absl::IsNotFound(text.status())) return std::nullopt;
  if (!text.ok()) return text.status();
  std::int64_t revision = 0;
  if (absl::SimpleAtoi(text->substr(0, text->find(' ')), &revision) && revision >= 0 &&
      *text == Encode(revision)) {
    return revision;
  }
  return absl::DataLossError("the file " + path + " is damaged; " + std::string(kRestoreAdvice));
}

}  // namespace graspdb::storage
