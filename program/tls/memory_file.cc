#include "program/tls/memory_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <system_error>

#include "absl/strings/str_cat.h"

namespace graspdb {
namespace {

// A file descriptor, negative with errno if there is none.
int MakeMemoryFile(const std::string& text, time_t time) {
  const int out = memfd_create("graspdb-tls", MFD_CLOEXEC);
  if (out < 0) return out;
  const std::array<timespec, 2> times = {timespec{time, 0}, timespec{time, 0}};
  if (write(out, text.data(), text.size()) == static_cast<ssize_t>(text.size()) &&
      futimens(out, times.data()) == 0) {
    return out;
  }
  const int error = errno;
  close(out);
  errno = error;
  return -1;
}

absl::Status NotReplaced() {
  return absl::ResourceExhaustedError(absl::StrCat("cannot keep keys and certificates in memory (",
                                                   std::generic_category().message(errno),
                                                   "); is /proc mounted?"));
}

}  // namespace

void MemoryFile::Open() { file_ = MakeMemoryFile("", 0); }

absl::Status MemoryFile::Replace(const std::string& text) {
  if (time_ != 0 && text == text_) return absl::OkStatus();
  if (file_ < 0) Open();
  if (file_ < 0 || access(path().c_str(), R_OK) != 0) return NotReplaced();
  const int next = MakeMemoryFile(text, time_ + 1);
  if (next < 0) return NotReplaced();
  absl::Status status = dup3(next, file_, O_CLOEXEC) == file_ ? absl::OkStatus() : NotReplaced();
  close(next);
  if (status.ok()) {
    text_ = text;
    ++time_;
  }
  return status;
}

std::string MemoryFile::path() const { return absl::StrCat("/proc/self/fd/", file_); }

}  // namespace graspdb
