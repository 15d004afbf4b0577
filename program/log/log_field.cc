#include "program/log/log_field.h"

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"

namespace graspdb {

std::string LogField(std::string_view value) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.:/[]%";
  if (!value.empty() && value.find_first_not_of(kPlain) == std::string_view::npos) {
    return std::string(value);
  }
  return absl::StrCat("\"", absl::Utf8SafeCEscape(std::string(value)), "\"");
}

}  // namespace graspdb
