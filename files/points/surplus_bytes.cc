#include "files/points/surplus_bytes.h"

#include <algorithm>
#include <fstream>
#include <vector>

#include "absl/strings/str_cat.h"

namespace graspdb::files {
namespace {

// The largest page of memory of a common system.
constexpr std::uint64_t kMaxPaddingBytes = std::uint64_t{64} * 1024;
constexpr std::size_t kBlockBytes = std::size_t{1} << 16;

// The bytes from the body's first one to the end of the file.
struct SurplusRead {
  std::uint64_t count = 0;
  std::uint64_t line_feeds = 0;
  std::uint64_t line_ends = 0;  // line feeds behind a carriage return
  bool has_zeros_only = true;   // behind the promised bytes
};

SurplusRead ReadFrom(std::ifstream& in, std::uint64_t promised) {
  SurplusRead out;
  std::vector<char> block(kBlockBytes);
  char previous = 0;
  while (in.read(block.data(), std::ssize(block)) || in.gcount() > 0) {
    for (std::streamsize i = 0; i < in.gcount(); ++i) {
      const char c = block[static_cast<std::size_t>(i)];
      out.line_feeds += c == '\n' ? 1 : 0;
      out.line_ends += c == '\n' && previous == '\r' ? 1 : 0;
      if (++out.count > promised && c != 0) out.has_zeros_only = false;
      previous = c;
    }
  }
  return out;
}

}  // namespace

std::string SurplusError(const std::filesystem::path& path, std::uint64_t body_offset,
                         std::uint64_t promised) {
  std::ifstream in(path, std::ios::binary);
  in.seekg(static_cast<std::streamoff>(body_offset));
  const SurplusRead read = ReadFrom(in, promised);
  if (read.count <= promised) return "";
  const std::uint64_t surplus = read.count - promised;
  if (read.line_ends == surplus && read.line_feeds == surplus) {
    return absl::StrCat("its body is ", surplus, " bytes longer than the ", promised,
                        " that its header promises, and each of its ", surplus,
                        " bytes 0A follows a 0D: it looks like a copy in text mode, which writes "
                        "0D 0A for each 0A");
  }
  if (read.has_zeros_only && surplus < kMaxPaddingBytes) return "";
  return absl::StrCat("its body ends at byte ", body_offset + promised, " by its header, and ",
                      surplus, " more bytes follow");
}

}  // namespace graspdb::files
