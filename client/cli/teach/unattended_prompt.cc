#include "client/cli/teach/unattended_prompt.h"

#include <algorithm>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "client/cli/base/command.h"
#include "program/base/monotonic_time.h"

namespace graspdb::client {
namespace {

constexpr int kMaxTries = 3;
constexpr absl::Duration kWatch = absl::Milliseconds(50);  // delay until Ctrl-C is noticed

// Returns false after Ctrl-C was pressed.
bool Wait(absl::Duration time) {
  const MonotonicTime end = MonotonicTime::Now() + time;
  while (!Interrupted() && MonotonicTime::Now() < end) {
    absl::SleepFor(std::min(kWatch, end - MonotonicTime::Now()));
  }
  return !Interrupted();
}

}  // namespace

std::optional<std::string> UnattendedPrompt::ReadLine(const std::string& question) {
  const bool is_view = absl::StartsWith(question, kViewPrompt);
  if (is_view && (how_.yes || how_.settle)) return TakeView(question);
  if (!how_.yes) return prompt_.ReadLine(question);
  if (Interrupted()) return std::nullopt;
  std::string answer;
  if (absl::StartsWith(question, kStablePosePrompt)) {
    if (has_stable_pose_) answer = "done";  // else it would start new ones for ever
    has_stable_pose_ = true;
  }
  prompt_.Print(absl::StrCat(question, answer));
  return answer;
}

std::optional<std::string> UnattendedPrompt::TakeView(const std::string& question) {
  tries_ = question == last_view_ ? tries_ + 1 : 1;
  last_view_ = question;
  if (tries_ > kMaxTries) return how_.yes ? std::nullopt : prompt_.ReadLine(question);
  prompt_.Print(question);
  if (!Wait(how_.settle.value_or(absl::ZeroDuration()))) return std::nullopt;
  return "";
}

}  // namespace graspdb::client
