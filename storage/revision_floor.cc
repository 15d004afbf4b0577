#include "storage/revision_floor.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include "absl/strings/numbers.h"
#include "storage/crc32c.h"

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

absl::Status DiskError(const std::string& path) {
  return absl::UnavailableError("cannot write " + path + " (" + std::strerror(errno) +
                                "); see to the disk");
}

// Writes `bytes` to `path` (or only opens it, for a directory) and waits for the disk.
absl::Status WriteAndSync(const std::string& path, int flags, std::string_view bytes) {
  const int file = open(path.c_str(), flags | O_CLOEXEC, 0644);
  if (file < 0) return DiskError(path);
  const bool written =
      bytes.empty() || write(file, bytes.data(), bytes.size()) == std::ssize(bytes);
  const bool synced = written && fsync(file) == 0;
  absl::Status status = synced ? absl::OkStatus() : DiskError(path);
  close(file);
  return status;
}

}  // namespace

absl::Status WriteRevisionFloor(const std::string& directory, std::int64_t revision) {
  const std::string path = FloorPath(directory);
  const std::string next = path + ".dbtmp";
  if (auto written = WriteAndSync(next, O_WRONLY | O_CREAT | O_TRUNC, Encode(revision));
      !written.ok()) {
    return written;
  }
  if (rename(next.c_str(), path.c_str()) != 0) return DiskError(path);
  return WriteAndSync(directory, O_RDONLY | O_DIRECTORY, "");
}

absl::StatusOr<std::optional<std::int64_t>> ReadRevisionFloor(const std::string& directory) {
  const std::string path = FloorPath(directory);
  std::error_code error;
  if (!std::filesystem::exists(path, error) && !error) return std::nullopt;
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  std::int64_t revision = 0;
  if (absl::SimpleAtoi(text.substr(0, text.find(' ')), &revision) && revision >= 0 &&
      text == Encode(revision)) {
    return revision;
  }
  return absl::DataLossError("the file " + path +
                             " is damaged; restore the database from a backup into an empty "
                             "directory");
}

}  // namespace graspdb::storage
