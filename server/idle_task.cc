#include "server/idle_task.h"

#include <cstdint>
#include <utility>

#include "server/background.h"

namespace graspdb::server {
namespace {

constexpr absl::Duration kPollInterval = absl::Seconds(10);

}  // namespace

IdleTask::IdleTask(LiveCatalogue& live, std::function<void()> task)
    : thread_([this, &live, task = std::move(task)] {
        LowerPriority();
        for (std::int64_t seen = -1; !Stopped(kPollInterval);) {
          live.CatchUp();
          const std::int64_t now = live.snapshot()->revision;
          if (now == seen) task();
          seen = now;
        }
      }) {}

IdleTask::~IdleTask() {
  {
    absl::MutexLock lock(&mutex_);
    stop_ = true;
  }
  thread_.join();
}

bool IdleTask::Stopped(absl::Duration wait) {
  absl::MutexLock lock(&mutex_);
  mutex_.AwaitWithTimeout(absl::Condition(&stop_), wait);
  return stop_;
}

}  // namespace graspdb::server
