// What `graspdb doctor` reports.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace graspdb::client {

enum class Severity { kAdvice, kWarning, kError };

// Something to look at.
struct Finding {
  Severity severity = Severity::kAdvice;
  std::string subject;  // resource name, "server" or "client"
  std::string text;     // what is wrong, and what to do
};
using Findings = std::vector<Finding>;

inline void AddFinding(Severity severity, std::string_view subject, std::string text,
                       Findings* out) {
  out->push_back({severity, std::string(subject), std::move(text)});
}

}  // namespace graspdb::client
