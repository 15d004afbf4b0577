#include "program/text/json_keys.h"

#include <algorithm>
#include <cstddef>
#include <set>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"

namespace graspdb {
namespace {

// Of a key in an error.
constexpr std::size_t kShownBytes = 64;

bool IsQuote(char c) { return c == '"' || c == '\''; }

// Protobuf's parser takes keys without quotes, too.
bool IsOfWord(char c) { return absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '_'; }

// The end of the text or word that begins at `begin`.
std::size_t EndOf(absl::string_view text, std::size_t begin) {
  std::size_t end = begin;
  if (!IsQuote(text[begin])) {
    while (end < text.size() && IsOfWord(text[end])) ++end;
    return end;
  }
  for (++end; end < text.size() && text[end] != text[begin]; ++end) {
    if (text[end] == '\\') ++end;
  }
  return std::min(end + 1, text.size());
}

bool IsFollowedByColon(absl::string_view text, std::size_t at) {
  while (at < text.size() && absl::ascii_isspace(static_cast<unsigned char>(text[at]))) ++at;
  return at < text.size() && text[at] == ':';
}

absl::Status HasTwice(absl::string_view text, std::size_t begin, absl::string_view key) {
  const auto lines =
      std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(begin), '\n');
  return absl::InvalidArgumentError(
      absl::StrCat("the key \"", absl::CHexEscape(key.substr(0, kShownBytes)),
                   "\" is twice in one object, again in line ", lines + 1, "; delete one of them"));
}

}  // namespace

absl::Status CheckJsonKeys(absl::string_view text) {
  std::vector<std::set<absl::string_view>> open;  // the keys of each object and list
  for (std::size_t at = 0; at < text.size(); ++at) {
    const char c = text[at];
    if (c == '{' || c == '[') open.emplace_back();
    if ((c == '}' || c == ']') && !open.empty()) open.pop_back();
    if (!IsQuote(c) && !IsOfWord(c)) continue;
    const std::size_t end = EndOf(text, at);
    if (!open.empty() && IsFollowedByColon(text, end)) {
      absl::string_view key = text.substr(at, end - at);
      if (IsQuote(c) && key.size() >= 2) key = key.substr(1, key.size() - 2);
      if (!open.back().insert(key).second) return HasTwice(text, at, key);
    }
    at = end - 1;
  }
  return absl::OkStatus();
}

}  // namespace graspdb
