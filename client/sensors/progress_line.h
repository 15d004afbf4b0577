// How far a long command is, on stderr.
#pragma once

namespace graspdb::client {

// On a terminal a bar that is redrawn; elsewhere a line at every quarter.
class ProgressLine {
 public:
  ProgressLine();
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void Report(int done, int total);

 private:
  bool is_terminal_;
  int last_ = -1;  // what was drawn: per cent on a terminal, else quarters
};

}  // namespace graspdb::client
