#include "storage/database/text_log.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdio>
#include <utility>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"

namespace graspdb::storage {
namespace {

constexpr std::size_t kFileBytes = 4U << 20;
// Of a line; the longest that were seen are those of a compaction with many files.
constexpr std::size_t kLineBytes = 8192;

class TextLog : public rocksdb::Logger {
 public:
  explicit TextLog(std::string path) : path_(std::move(path)) {
    absl::MutexLock lock(&mutex_);
    Begin();
  }
  ~TextLog() override {
    if (file_ >= 0) close(file_);
  }

  using rocksdb::Logger::Logv;
  void Logv(const char* format, va_list arguments) override {
    std::array<char, kLineBytes> text;
    const int length = vsnprintf(text.data(), text.size(), format, arguments);
    if (length < 0) return;
    std::string line = absl::FormatTime("%Y/%m/%d-%H:%M:%E6S ", absl::Now(), absl::UTCTimeZone());
    line.append(text.data(), std::min(static_cast<std::size_t>(length), text.size() - 1));
    if (line.back() != '\n') line += '\n';
    absl::MutexLock lock(&mutex_);
    if (bytes_ > kFileBytes) Begin();
    const ssize_t written = write(file_, line.data(), line.size());
    bytes_ += static_cast<std::size_t>(std::max<ssize_t>(written, 0));
  }

 private:
  void Begin() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    if (file_ >= 0) close(file_);
    std::rename(path_.c_str(), (path_ + ".old").c_str());
    file_ = open(path_.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
    bytes_ = 0;
  }

  const std::string path_;
  absl::Mutex mutex_;
  int file_ ABSL_GUARDED_BY(mutex_) = -1;
  std::size_t bytes_ ABSL_GUARDED_BY(mutex_) = 0;
};

}  // namespace

std::shared_ptr<rocksdb::Logger> OpenTextLog(const std::string& directory) {
  return std::make_shared<TextLog>(directory + "/LOG");
}

}  // namespace graspdb::storage
