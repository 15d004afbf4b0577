#include "server/idle_task.h"

#include <cstdint>
#include <utility>

#include "server/background.h"

namespace graspdb::server {

IdleTask::IdleTask(LiveCatalogue& live, Tasks tasks, std::chrono::nanoseconds interval)
    : thread_([this, &live, tasks = std::move(tasks), interval] {
        LowerPriority();
        for (std::int64_t seen = -1; !stop_.Wait(interval);) {
          live.CatchUp();
          tasks.always();
          const std::int64_t now = live.snapshot()->revision;
          if (now == seen) tasks.when_idle();
          seen = now;
        }
      }) {}

IdleTask::~IdleTask() {
  stop_.Raise();
  thread_.join();
}

}  // namespace graspdb::server
