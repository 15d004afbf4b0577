#include "server/requests/respond.h"

#include <algorithm>

#include "absl/strings/escaping.h"

namespace graspdb::server {

absl::StatusOr<std::size_t> PageSize(std::int32_t requested) {
  if (requested < 0) return InvalidField("page_size", "must not be negative");
  return requested == 0 ? 100 : static_cast<std::size_t>(std::min(requested, 1000));
}

std::string PageTokenAfter(std::string_view last_name) {
  return absl::WebSafeBase64Escape(std::string(last_name));
}

absl::StatusOr<std::string> NameFromPageToken(std::string_view token, std::string_view prefix) {
  if (token.empty()) return "";
  std::string name;
  if (!absl::WebSafeBase64Unescape(std::string(token), &name) || !name.starts_with(prefix) ||
      PageTokenAfter(name) != token) {
    return InvalidField("page_token", "is not a page token of this list");
  }
  return name;
}

}  // namespace graspdb::server
