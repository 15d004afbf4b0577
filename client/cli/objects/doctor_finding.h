// What `graspdb doctor` reports.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "absl/strings/str_cat.h"

namespace graspdb::client {

enum class Severity { kAdvice, kWarning, kError };

// Something to look at.
struct Finding {
  Severity severity = Severity::kAdvice;
  std::string subject;  // resource name, "server" or "client"
  std::string text;     // what is wrong, and what to do
};
using Findings = std::vector<Finding>;

// The text is that of the parts, one behind the other, as of absl::StrCat.
template <typename... Parts>
void AddFinding(Findings* out, Severity severity, std::string_view subject, const Parts&... parts) {
  out->push_back({severity, std::string(subject), absl::StrCat(parts...)});
}
template <typename... Parts>
void AddAdvice(Findings* out, std::string_view subject, const Parts&... parts) {
  AddFinding(out, Severity::kAdvice, subject, parts...);
}
template <typename... Parts>
void AddWarning(Findings* out, std::string_view subject, const Parts&... parts) {
  AddFinding(out, Severity::kWarning, subject, parts...);
}
template <typename... Parts>
void AddError(Findings* out, std::string_view subject, const Parts&... parts) {
  AddFinding(out, Severity::kError, subject, parts...);
}

}  // namespace graspdb::client
