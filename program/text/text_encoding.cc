#include "program/text/text_encoding.h"

#include <algorithm>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"

namespace graspdb {
namespace {

// By a byte order mark, or by the zeros beside the first two letters, which are of ASCII.
bool IsWide(absl::string_view text) {
  if (absl::StartsWith(text, "\xFF\xFE") || absl::StartsWith(text, "\xFE\xFF")) return true;
  const absl::string_view start = text.substr(0, 4);
  const auto zeros = std::count(start.begin(), start.end(), '\0');
  return zeros == 2 || zeros == 3;
}

}  // namespace

absl::Status TakeUtf8(absl::string_view name, std::string* text) {
  if (IsWide(*text)) {
    return absl::InvalidArgumentError(
        absl::StrCat(name,
                     " has the encoding UTF-16 or UTF-32; save it with the encoding UTF-8, "
                     "or convert it: iconv -f UTF-16 -t UTF-8"));
  }
  if (absl::StartsWith(*text, kByteOrderMark)) text->erase(0, kByteOrderMark.size());
  return absl::OkStatus();
}

}  // namespace graspdb
