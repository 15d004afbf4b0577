// Teaching at a terminal.
#pragma once

#include <cstdio>
#include <optional>
#include <string>

#include "client/teaching/turntable/turn_dialogue.h"

namespace graspdb::client {

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

}  // namespace graspdb::client
