// A file in memory for code that reads the path of a file again and again.
#pragma once

#include <sys/types.h>

#include <string>

#include "absl/status/status.h"

namespace graspdb {

// In no folder, and gone with the process however that ends. Its file descriptor is not closed:
// a reader may outlive this, and would read what gets the number next. One thread at a time may
// use it; others may read the path meanwhile.
class MemoryFile {
 public:
  // Empty, with a time of modification of 0 (1970) until the first Replace().
  MemoryFile() { Open(); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  // Replaces the text at once, as by renaming: no reader gets parts of two. Each new text has
  // another second as its time of modification, by which a reader of several files notices it.
  // RESOURCE_EXHAUSTED, with the text of before, if the system has no file descriptor or memory or
  // no /proc.
  absl::Status Replace(const std::string& text);

  // That of no file if the system had none so far.
  std::string path() const;

 private:
  void Open();

  int file_ = -1;
  std::string text_;
  time_t time_ = 0;
};

}  // namespace graspdb
