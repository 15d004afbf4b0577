// fsync(2) of a test program: records what is flushed, and fails on request.
#pragma once

#include <filesystem>

namespace graspdb {

// Exists once at a time. Other threads may call fsync() meanwhile.
class WatchedSyncs {
 public:
  WatchedSyncs();
  ~WatchedSyncs();
  WatchedSyncs(const WatchedSyncs&) = delete;
  WatchedSyncs& operator=(const WatchedSyncs&) = delete;

  // From now on fsync() of each folder, or of each file, fails with this errno.
  void FailFolders(int error);
  void FailFiles(int error);

  // Whether the file or folder at `path` was flushed since the constructor.
  bool Flushed(const std::filesystem::path& path) const;
};

}  // namespace graspdb
