#include "client/cli/teach/guided_teach.h"

#include <algorithm>
#include <cstdio>
#include <memory>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "base/status_macros.h"
#include "client/cli/base/camera.h"
#include "client/cli/objects/taught_report.h"
#include "client/teaching/turntable/guided_teaching.h"
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

// Prints prompts to `out` and reads answers from `in`, until its end or Ctrl-C. Not thread-safe.
class ConsolePrompt : public TeachingPrompt {
 public:
  // Both must outlive this.
  ConsolePrompt(std::FILE* in, std::FILE* out) : in_(in), out_(out) {}

  void Print(const std::string& text) override;
  std::optional<std::string> ReadLine(const std::string& question) override;

 private:
  std::FILE* const in_;
  std::FILE* const out_;
};

void ConsolePrompt::Print(const std::string& text) {
  std::fprintf(out_, "%s\n", text.c_str());
  std::fflush(out_);
}

std::optional<std::string> ConsolePrompt::ReadLine(const std::string& question) {
  if (Interrupted()) return std::nullopt;
  std::fprintf(out_, "%s", question.c_str());
  std::fflush(out_);
  std::string line;
  int c = 0;
  // Ctrl-C interrupts the read, which ends the input too.
  while ((c = std::fgetc(in_)) != EOF && c != '\n') line += static_cast<char>(c);
  if (c == EOF && line.empty()) {
    std::fprintf(out_, "\n");
    return std::nullopt;
  }
  return line;
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

absl::Status RunGuidedTeach(const GlobalOptions& global, const GuidedTeachOptions& options) {
  Client client = Connect(global);
  const absl::StatusOr<v1::Cell> cell = client.GetCell(ResourceName("cells", options.cell));
  if (absl::IsNotFound(cell.status())) {
    return absl::NotFoundError(absl::StrCat("there is no cell ", options.cell,
                                            " with the camera's pose; empty the table and run "
                                            "`graspdb cells level ",
                                            options.cell, " --sensor ", options.sensor, "`"));
  }
  if (!cell.ok()) return cell.status();
  ASSIGN_OR_RETURN(const std::unique_ptr<DepthSensor> sensor, OpenCamera(options.sensor));
  GuidedOptions guided{
      .object_id = options.object,
      .display_name = options.display_name.empty() ? options.object : options.display_name,
      .cell = *cell,
      .axis = {},
      .plate_height_m = options.plate_height_m,
      .step_deg = options.step_deg,
      .clockwise = options.clockwise};
  if (!options.axis.empty()) guided.axis = Eigen::Vector2d(options.axis[0], options.axis[1]);
  ConsolePrompt console(stdin, global.json ? stderr : stdout);
  UnattendedPrompt prompt(console, options.unattended);
  ASSIGN_OR_RETURN(const GuidedCounts counts,
                   GuidedTeaching(*sensor, client, prompt, guided).Run());
  absl::Status reported =
      ReportTaught(global, client, {.created = counts.taught},
                   counts.stopped ? "; run the same command again to go on" : "")
          .status();
  if (!reported.ok() || !counts.stopped || !options.unattended.yes) return reported;
  return absl::FailedPreconditionError(
      "teaching stopped before all views were taught; see the message of the last view");
}

}  // namespace graspdb::client
