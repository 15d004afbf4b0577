// Teaching at a terminal.
#pragma once

#include <cstdio>
#include <optional>
#include <string>

#include "client/teaching/turntable/teaching_prompt.h"

namespace graspdb::client {

// Asks on `out` and reads the answers from `in`: at its end, and once Ctrl-C was pressed, nobody
// answers any more. Not thread-safe.
class ConsolePrompt : public TeachingPrompt {
 public:
  // Both must outlive this.
  ConsolePrompt(std::FILE* in, std::FILE* out) : in_(in), out_(out) {}

  void Say(const std::string& text) override;
  std::optional<std::string> Ask(const std::string& question) override;

 private:
  std::FILE* const in_;
  std::FILE* const out_;
};

}  // namespace graspdb::client
