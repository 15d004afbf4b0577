// `graspdb teach OBJECT --sensor SPEC`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "client/cli/base/command.h"
#include "client/teaching/turntable/turn_dialogue.h"

namespace graspdb::client {

struct Unattended {
  bool yes = false;  // answers every prompt as Enter does
  // Wait before each view, instead of for Enter; none: `yes` decides, without a wait.
  std::optional<absl::Duration> settle = {};
};

// Answers prompts in place of the person at `prompt`, which prints everything and answers the rest.
// With `yes` one stable pose is taught, and a view that fails three times ends teaching, as Ctrl-C
// does. Not thread-safe.
class UnattendedPrompt : public TeachingPrompt {
 public:
  // `prompt` must outlive this.
  UnattendedPrompt(TeachingPrompt& prompt, const Unattended& how) : prompt_(prompt), how_(how) {}

  void Print(const std::string& text) override { prompt_.Print(text); }
  std::optional<std::string> ReadLine(const std::string& question) override;

 private:
  std::optional<std::string> TakeView(const std::string& question);

  TeachingPrompt& prompt_;
  const Unattended how_;
  bool has_stable_pose_ = false;
  std::string last_view_;
  int tries_ = 0;
};

struct GuidedTeachOptions {
  std::string object;
  std::string display_name;
  std::string cell;          // id
  std::string sensor;        // see OpenSensor
  std::vector<double> axis;  // X, Y, m; or none
  double plate_height_m = 0;
  double step_deg = 20;
  bool clockwise = false;
  Unattended unattended;
};

// Guides the person at the terminal (on stderr with --json) and prints the result. NOT_FOUND, with
// advice, when there is no such cell; FAILED_PRECONDITION when an unattended run ended before
// everything was taught; errors of OpenSensor and GuidedTeaching.
absl::Status RunGuidedTeach(const GlobalOptions& global, const GuidedTeachOptions& options);

}  // namespace graspdb::client
