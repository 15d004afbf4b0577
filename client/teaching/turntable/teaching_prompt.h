// Who is taught with: a person at a terminal, or a script.
#pragma once

#include <optional>
#include <string>

namespace graspdb::client {

// How questions begin that a script must know, because Enter answers them again and again.
inline constexpr char kAskStablePose[] = "id of the stable pose";
inline constexpr char kAskView[] = "turn the object to ";

// Asked by one thread; need not be thread-safe.
class TeachingPrompt {
 public:
  virtual ~TeachingPrompt() = default;

  // Tells a line, without its end.
  virtual void Say(const std::string& text) = 0;

  // What is answered, without the end of the line; nothing when nobody will answer any more.
  virtual std::optional<std::string> Ask(const std::string& question) = 0;
};

}  // namespace graspdb::client
