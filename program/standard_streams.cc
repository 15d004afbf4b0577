#include "program/standard_streams.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <string>
#include <system_error>

#include "absl/strings/str_cat.h"

namespace graspdb {
namespace {

bool IsClosed(int stream) { return fcntl(stream, F_GETFD) == -1 && errno == EBADF; }

}  // namespace

void OpenStandardStreams() {
  // In this order: open() takes the lowest free number. Standard output for reading, so that
  // writing to it fails.
  if (IsClosed(STDIN_FILENO)) open("/dev/null", O_RDONLY);
  if (IsClosed(STDOUT_FILENO)) open("/dev/null", O_RDONLY);
  if (IsClosed(STDERR_FILENO)) open("/dev/null", O_WRONLY);
}

absl::Status FlushOutput() {
  const bool had_failed = std::ferror(stdout) != 0;
  if (std::fflush(stdout) != 0) {
    return absl::UnavailableError(absl::StrCat("cannot write the output (",
                                               std::generic_category().message(errno),
                                               "); check where it goes"));
  }
  if (!had_failed) return absl::OkStatus();
  return absl::UnavailableError("cannot write the output; check where it goes");
}

int WithOutputWritten(const char* program, int status) {
  const absl::Status written = FlushOutput();
  if (written.ok()) return status;
  std::fprintf(stderr, "%s: %s\n", program, std::string(written.message()).c_str());
  return status == 0 ? 1 : status;
}

}  // namespace graspdb
