// The dialogue of teaching: with a person at a terminal, or a script.
#pragma once

#include <optional>
#include <string>

namespace graspdb::client {

// Prefixes of the prompts that a script must distinguish, as Enter would repeat them for ever.
inline constexpr char kStablePosePrompt[] = "id of the stable pose";
inline constexpr char kViewPrompt[] = "turn the object to ";

// Called from one thread; need not be thread-safe.
class TeachingPrompt {
 public:
  virtual ~TeachingPrompt() = default;

  // Prints a line; `text` has no line end.
  virtual void Print(const std::string& text) = 0;

  // Prints a question and returns the answer without its line end; nothing at the end of the input.
  virtual std::optional<std::string> ReadLine(const std::string& question) = 0;
};

}  // namespace graspdb::client
