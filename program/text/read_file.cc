#include "program/text/read_file.h"

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "program/text/text_encoding.h"

namespace graspdb {
namespace {

constexpr std::size_t kFirstRead = 64 << 10;  // bytes; each further read doubles what is there

std::string SizeText(std::size_t bytes) {
  if (bytes % (1 << 20) == 0) return absl::StrCat(bytes >> 20, " MiB");
  return absl::StrCat(bytes >> 10, " KiB");
}

absl::Status TooLarge(const std::filesystem::path& path, std::size_t max_bytes) {
  return absl::InvalidArgumentError(absl::StrCat(path.string(), " is larger than ",
                                                 SizeText(max_bytes), "; is it the right file?"));
}

}  // namespace

absl::StatusOr<std::string> ReadFile(const std::filesystem::path& path, std::size_t max_bytes) {
  std::error_code none;  // a pipe has no size
  if (std::filesystem::is_regular_file(path, none) &&
      std::filesystem::file_size(path, none) > max_bytes && !none) {
    return TooLarge(path, max_bytes);
  }
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  std::string out;
  while (in && out.size() <= max_bytes) {
    const std::size_t begin = out.size();
    out.resize(std::min(std::max(kFirstRead, 2 * begin), max_bytes + 1));
    in.read(out.data() + begin, static_cast<std::streamsize>(out.size() - begin));
    out.resize(begin + static_cast<std::size_t>(in.gcount()));
  }
  if (!in.is_open() && (errno == ENOENT || errno == ENOTDIR)) {
    return absl::NotFoundError(absl::StrCat(path.string(), " does not exist; check the path"));
  }
  if (!in.is_open() || in.bad()) {
    return absl::FailedPreconditionError(absl::StrCat(path.string(), " cannot be read (",
                                                      std::generic_category().message(errno),
                                                      "); name a file that you may read"));
  }
  if (out.size() > max_bytes) return TooLarge(path, max_bytes);
  return out;
}

absl::StatusOr<std::string> ReadTextFile(const std::filesystem::path& path, std::size_t max_bytes) {
  ASSIGN_OR_RETURN(std::string text, ReadFile(path, max_bytes));
  RETURN_IF_ERROR(TakeUtf8(path.string(), &text));
  return text;
}

}  // namespace graspdb
