// Progress of a long command, on stderr.
#pragma once

#include <string>

namespace graspdb::client {

// On a terminal a bar that is redrawn; elsewhere a line at every quarter.
class ProgressLine {
 public:
  // `unit`: the counted items.
  explicit ProgressLine(std::string unit = "captures");
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void Report(int done, int total);

 private:
  std::string unit_;
  bool is_terminal_;
  int last_ = -1;  // last drawn: per cent on a terminal, else quarters
};

}  // namespace graspdb::client
