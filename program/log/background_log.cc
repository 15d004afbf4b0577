#include "program/log/background_log.h"

#include <pthread.h>
#include <spdlog/async_logger.h>
#include <spdlog/details/thread_pool.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <string_view>
#include <utility>

#include "absl/strings/str_cat.h"
#include "program/log/log.h"

namespace graspdb {
namespace {

// Lines that may wait, some 400 bytes each.
constexpr std::size_t kWaitingLines = 4096;

// Time of the program's end for the lines that still wait.
constexpr std::chrono::seconds kEndTime{1};

// Writes lines to standard error, on the thread of the log. Without stdio: its lock would stop what
// others print there while a line waits for the reader.
class StderrSink final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  explicit StderrSink(std::weak_ptr<spdlog::details::thread_pool> queue)
      : queue_(std::move(queue)) {}

  std::int64_t lost() const {
    const auto queue = queue_.lock();
    return unwritten_ +
           (queue == nullptr ? 0 : static_cast<std::int64_t>(queue->overrun_counter()));
  }
  // Waits until the lines before the last flush are written.
  void AwaitFlush(std::chrono::seconds time) {
    std::unique_lock lock(flush_mutex_);
    flush_ended_.wait_for(lock, time, [this] { return flushed_; });
  }

 private:
  void sink_it_(const spdlog::details::log_msg& message) override {
    const std::int64_t lost_count = lost();
    if (lost_count > reported_) {
      const std::string note = absl::StrCat("event=log_lines_lost count=", lost_count - reported_);
      if (Write({message.logger_name, spdlog::level::warn, note})) reported_ = lost_count;
    }
    if (!Write(message)) ++unwritten_;
  }
  void flush_() override {
    const std::scoped_lock lock(flush_mutex_);
    flushed_ = true;
    flush_ended_.notify_all();
  }

  // Whether it was written.
  bool Write(const spdlog::details::log_msg& message) {
    spdlog::memory_buf_t line;
    formatter_->format(message, line);
    std::string_view rest(line.data(), line.size());
    while (!rest.empty()) {
      const ssize_t count = write(STDERR_FILENO, rest.data(), rest.size());
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) return false;
      rest.remove_prefix(static_cast<std::size_t>(count));
    }
    return true;
  }

  const std::weak_ptr<spdlog::details::thread_pool> queue_;
  std::atomic<std::int64_t> unwritten_ = 0;
  std::int64_t reported_ = 0;  // of the lost lines
  std::mutex flush_mutex_;
  std::condition_variable flush_ended_;
  bool flushed_ = false;
};

struct BackgroundLog {
  std::shared_ptr<spdlog::details::thread_pool> queue;
  std::shared_ptr<StderrSink> sink;
  std::shared_ptr<spdlog::async_logger> logger;
};

// Never destroyed: threads may log until the process is gone, and the log's own thread may wait for
// a reader that never reads.
BackgroundLog& TheLog() {
  static auto* const log = new BackgroundLog;
  return *log;
}

// A reader that is gone is an error of write(), not the end of the program.
void BlockSignals() {
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, nullptr);
}

void EndLog() {
  TheLog().logger->flush();
  TheLog().sink->AwaitFlush(kEndTime);
}

}  // namespace

void StartBackgroundLog(const std::string& program, const std::string& level) {
  BackgroundLog& log = TheLog();
  log.queue = std::make_shared<spdlog::details::thread_pool>(kWaitingLines, 1, BlockSignals);
  log.sink = std::make_shared<StderrSink>(log.queue);
  log.logger = std::make_shared<spdlog::async_logger>(
      program, log.sink, log.queue, spdlog::async_overflow_policy::overrun_oldest);
  StartLog(log.logger, level);
  std::atexit(EndLog);
}

std::int64_t LostLogLines() {
  const BackgroundLog& log = TheLog();
  return log.sink == nullptr ? 0 : log.sink->lost();
}

}  // namespace graspdb
