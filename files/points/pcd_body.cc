#include "files/points/pcd_body.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>
#include <string>
#include <system_error>
#include <vector>

#include "absl/strings/escaping.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "files/points/surplus_bytes.h"

namespace graspdb::files {
namespace {

static_assert(std::endian::native == std::endian::little, "PCD bodies are little-endian");

// Three bytes of LZF expand to at most 264; larger declared sizes are rejected before allocation.
constexpr std::int64_t kMaxUnpacked = 264 / 3;

absl::Status Damaged(const std::filesystem::path& path, const std::string& what) {
  return absl::InvalidArgumentError(
      absl::StrCat(path.string(), " is damaged: ", what, "; copy or capture the cloud again"));
}

// "inf" and numbers beyond single precision are rejected, as PCL would read a zero.
bool IsNumber(absl::string_view word) {
  double value = 0;
  if (!absl::SimpleAtod(word, &value)) return false;
  return std::isnan(value) || std::abs(value) <= std::numeric_limits<float>::max();
}

absl::Status CheckAscii(const std::filesystem::path& path, const PcdHeader& header,
                        std::ifstream& in) {
  const auto expected = static_cast<std::size_t>(header.numbers_per_point());
  std::int64_t rows = 0;
  std::string line;
  while (std::getline(in, line)) {
    const std::vector<absl::string_view> words =
        absl::StrSplit(line, absl::ByAnyChar(" \t\r"), absl::SkipEmpty());
    if (words.empty()) continue;
    ++rows;
    if (words.size() != expected) {
      return Damaged(path, absl::StrCat("row ", rows, " of its points has ", words.size(),
                                        " numbers instead of ", expected));
    }
    const auto bad = std::find_if_not(words.begin(), words.end(), IsNumber);
    if (bad != words.end()) {
      return Damaged(path, absl::StrCat("row ", rows, " of its points has \"",
                                        absl::CHexEscape(bad->substr(0, 20)),
                                        "\" where a finite number or nan belongs"));
    }
  }
  if (rows == header.point_count()) return absl::OkStatus();
  return Damaged(path, absl::StrCat("it has ", rows, " points, and its header promises ",
                                    header.point_count()));
}

absl::Status CheckSurplus(const std::filesystem::path& path, const PcdHeader& header,
                          std::int64_t promised) {
  const std::string error =
      SurplusError(path, header.body_offset, static_cast<std::uint64_t>(promised));
  return error.empty() ? absl::OkStatus() : Damaged(path, error);
}

absl::Status CheckBinary(const std::filesystem::path& path, const PcdHeader& header,
                         std::int64_t body_bytes) {
  const std::int64_t promised = header.point_count() * header.point_bytes();
  if (body_bytes == promised) return absl::OkStatus();
  if (body_bytes > promised) return CheckSurplus(path, header, promised);
  return Damaged(path, absl::StrCat("it has ", body_bytes, " bytes of points, and its header ",
                                    "promises ", promised));
}

absl::Status CheckCompressed(const std::filesystem::path& path, const PcdHeader& header,
                             std::int64_t body_bytes, std::ifstream& in) {
  const auto is_padding = [](const PcdHeader::Field& field) { return field.name == "_"; };
  if (std::any_of(header.fields.begin(), header.fields.end(), is_padding)) {
    return absl::InvalidArgumentError(absl::StrCat(
        path.string(), " has padding fields in a compressed body, which readers disagree on; ",
        "write it again as DATA binary"));
  }
  std::uint32_t sizes[2] = {0, 0};  // compressed, uncompressed
  if (!in.read(reinterpret_cast<char*>(sizes), sizeof(sizes))) {
    return Damaged(path, "its compressed body ends before its sizes");
  }
  const std::int64_t promised = header.point_count() * header.point_bytes();
  if (sizes[1] != promised) {
    return Damaged(path, absl::StrCat("its body unpacks to ", sizes[1],
                                      " bytes, and its header promises ", promised));
  }
  const std::int64_t there = body_bytes - std::int64_t{sizeof(sizes)};
  if (sizes[0] == 0 || sizes[0] > there) {
    return Damaged(
        path, absl::StrCat("its body declares ", sizes[0], " compressed bytes, and has ", there));
  }
  if (promised > std::int64_t{sizes[0]} * kMaxUnpacked) {
    return Damaged(path, absl::StrCat("its ", sizes[0], " compressed bytes cannot hold the ",
                                      promised, " bytes that its header promises"));
  }
  if (sizes[0] == there) return absl::OkStatus();
  return CheckSurplus(path, header, std::int64_t{sizeof(sizes)} + sizes[0]);
}

}  // namespace

absl::Status CheckPcdBody(const std::filesystem::path& path, const PcdHeader& header) {
  std::error_code error;
  const auto file_bytes = static_cast<std::int64_t>(std::filesystem::file_size(path, error));
  std::ifstream in(path, std::ios::binary);
  in.seekg(static_cast<std::streamoff>(header.body_offset));
  if (error || !in) return Damaged(path, "its body cannot be reached");
  const std::int64_t body_bytes = file_bytes - static_cast<std::int64_t>(header.body_offset);
  switch (header.encoding) {
    case PcdHeader::Encoding::kAscii:
      return CheckAscii(path, header, in);
    case PcdHeader::Encoding::kBinary:
      return CheckBinary(path, header, body_bytes);
    case PcdHeader::Encoding::kBinaryCompressed:
      return CheckCompressed(path, header, body_bytes, in);
  }
  return Damaged(path, "its encoding is unknown");
}

}  // namespace graspdb::files
