// Programs as processes.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace graspdb::end_to_end {

// Exit status and output of a program.
struct Finished {
  int exit_status = -1;  // 128 + n when signal n ended it
  std::string out;
  std::string err;
};

// A running program; killed by the destructor. Its output is in files below `folder`.
class Process {
 public:
  Process(const std::filesystem::path& folder, const std::vector<std::string>& command);
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  pid_t id() const { return pid_; }
  void Signal(int signal) const;
  // Waits for its end.
  Finished Wait();
  // Waits until its standard output has a line that begins with `start`, and returns the rest of
  // the line; empty when the program ended first.
  std::string WaitForLine(const std::string& start);
  // Its standard error so far. Logs are written by a thread of their own, so that a line may come
  // after the answer of the call that it is about.
  std::string Errors() const;
  // Waits until its standard error has `text`; false when the program ended without it.
  bool WaitForError(const std::string& text);

 private:
  bool HasEnded();

  std::filesystem::path out_;
  std::filesystem::path err_;
  pid_t pid_ = -1;
  int status_ = 0;
  bool ended_ = false;
};

// Runs a program to its end.
Finished RunProgram(const std::filesystem::path& folder, const std::vector<std::string>& command);

}  // namespace graspdb::end_to_end
