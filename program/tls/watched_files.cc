#include "program/tls/watched_files.h"

#include <sys/stat.h>

#include <chrono>
#include <utility>

namespace graspdb {
namespace {

// How long a revoked token is still accepted. Twice as often costs twice as many stat calls.
constexpr std::chrono::seconds kPollInterval{1};

}  // namespace

bool WatchedFiles::Stamp::operator==(const Stamp& other) const {
  return inode == other.inode && size == other.size && changed.tv_sec == other.changed.tv_sec &&
         changed.tv_nsec == other.changed.tv_nsec;
}

WatchedFiles::WatchedFiles(std::vector<std::string> paths)
    : paths_(std::move(paths)), stamps_(Stamps()) {}

WatchedFiles::~WatchedFiles() {
  stop_.Raise();
  if (thread_.joinable()) thread_.join();
}

void WatchedFiles::Start(std::function<bool()> on_change) {
  thread_ = std::thread([this, on_change = std::move(on_change)] {
    bool is_done = true;
    while (!stop_.Wait(kPollInterval)) {
      std::vector<Stamp> now = Stamps();
      if (is_done && now == stamps_) continue;
      stamps_ = std::move(now);
      is_done = on_change();
    }
  });
}

std::vector<WatchedFiles::Stamp> WatchedFiles::Stamps() const {
  std::vector<Stamp> out;
  out.reserve(paths_.size());
  for (const std::string& path : paths_) {
    struct stat file {};
    const bool found = stat(path.c_str(), &file) == 0;
    out.push_back(found ? Stamp{file.st_ino, file.st_size, file.st_mtim} : Stamp());
  }
  return out;
}

}  // namespace graspdb
