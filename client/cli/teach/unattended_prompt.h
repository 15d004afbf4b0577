// Teaching without anybody at the terminal, as with a turntable that a motor turns.
#pragma once

#include <optional>
#include <string>

#include "absl/time/time.h"
#include "client/teaching/turntable/teaching_prompt.h"

namespace graspdb::client {

struct Unattended {
  bool yes = false;  // every question is answered as Enter does
  // Before each view so long is waited instead of for Enter; none: as `yes` says, without waiting.
  std::optional<absl::Duration> settle = {};
};

// Answers for the person who would be asked by `prompt`, which is told everything and asked the
// rest. With `yes` one stable pose is taught, and a view that fails three times ends it, as Ctrl-C
// does. Not thread-safe.
class UnattendedPrompt : public TeachingPrompt {
 public:
  // `prompt` must outlive this.
  UnattendedPrompt(TeachingPrompt& prompt, const Unattended& how) : prompt_(prompt), how_(how) {}

  void Say(const std::string& text) override { prompt_.Say(text); }
  std::optional<std::string> Ask(const std::string& question) override;

 private:
  std::optional<std::string> TakeView(const std::string& question);

  TeachingPrompt& prompt_;
  const Unattended how_;
  bool has_stable_pose_ = false;
  std::string last_view_;
  int tries_ = 0;
};

}  // namespace graspdb::client
