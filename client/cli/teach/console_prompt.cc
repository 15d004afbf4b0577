#include "client/cli/teach/console_prompt.h"

#include "client/cli/base/command.h"

namespace graspdb::client {

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

}  // namespace graspdb::client
