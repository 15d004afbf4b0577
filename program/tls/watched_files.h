// Files that are read again when they change.
#pragma once

#include <sys/types.h>

#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "program/base/stop_flag.h"

namespace graspdb {

// Polls the files' inode, size and time of change each second; also notices a file that is replaced
// by another one, or reached by another symbolic link.
class WatchedFiles {
 public:
  // Changes count from now on.
  explicit WatchedFiles(std::vector<std::string> paths);
  ~WatchedFiles();
  WatchedFiles(const WatchedFiles&) = delete;
  WatchedFiles& operator=(const WatchedFiles&) = delete;

  // Calls `on_change`, which must not throw, on a thread of this after each change, and each second
  // while it returns false. To be called once.
  void Start(std::function<bool()> on_change);

 private:
  struct Stamp {
    ino_t inode = 0;
    off_t size = -1;  // no such file
    timespec changed{};
    bool operator==(const Stamp& other) const;
  };

  std::vector<Stamp> Stamps() const;

  const std::vector<std::string> paths_;
  std::vector<Stamp> stamps_;
  StopFlag stop_;
  std::thread thread_;
};

}  // namespace graspdb
