#include "tests/testing/watched_syncs.h"

#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <mutex>
#include <set>
#include <utility>

namespace graspdb {
namespace {

struct SyncState {
  std::mutex mutex;
  bool is_watching = false;
  int folder_error = 0;
  int file_error = 0;
  std::set<std::pair<dev_t, ino_t>> flushed;
};

SyncState& TheSyncState() {
  static auto* const state = new SyncState;  // threads may flush after static objects
  return *state;
}

// 0 or the errno with which fsync() fails.
int WatchSync(int file) {
  struct stat found {};
  if (fstat(file, &found) != 0) return 0;
  SyncState& state = TheSyncState();
  const std::scoped_lock lock(state.mutex);
  if (!state.is_watching) return 0;
  const int error = S_ISDIR(found.st_mode) ? state.folder_error : state.file_error;
  if (error == 0) state.flushed.emplace(found.st_dev, found.st_ino);
  return error;
}

}  // namespace

WatchedSyncs::WatchedSyncs() {
  const std::scoped_lock lock(TheSyncState().mutex);
  TheSyncState().is_watching = true;
}

WatchedSyncs::~WatchedSyncs() {
  SyncState& state = TheSyncState();
  const std::scoped_lock lock(state.mutex);
  state.is_watching = false;
  state.folder_error = 0;
  state.file_error = 0;
  state.flushed.clear();
}

void WatchedSyncs::FailFolders(int error) {
  const std::scoped_lock lock(TheSyncState().mutex);
  TheSyncState().folder_error = error;
}

void WatchedSyncs::FailFiles(int error) {
  const std::scoped_lock lock(TheSyncState().mutex);
  TheSyncState().file_error = error;
}

bool WatchedSyncs::Flushed(const std::filesystem::path& path) const {
  struct stat found {};
  if (stat(path.c_str(), &found) != 0) return false;
  const std::scoped_lock lock(TheSyncState().mutex);
  return TheSyncState().flushed.contains({found.st_dev, found.st_ino});
}

}  // namespace graspdb

// Takes the place of the C library's function in this program and its libraries.
extern "C" int fsync(int file) {
  if (const int error = graspdb::WatchSync(file); error != 0) {
    errno = error;
    return -1;
  }
  return static_cast<int>(syscall(SYS_fsync, file));
}
