#include "server/live/idle_task.h"

#include <spdlog/spdlog.h>

#include <cstdint>
#include <string>
#include <utility>

#include "program/log/log_field.h"
#include "server/base/background.h"

namespace graspdb::server {
namespace {

void RunTask(const std::function<void()>& task) {
  const absl::Status done = Guarded([&task] {
    task();
    return absl::OkStatus();
  });
  if (done.ok()) return;
  spdlog::error("event=idle_task_failed error={}", LogField(std::string(done.message())));
}

}  // namespace

IdleTask::IdleTask(LiveCatalogue& live, Tasks tasks, std::chrono::nanoseconds interval)
    : thread_([this, &live, tasks = std::move(tasks), interval] {
        LowerPriority();
        for (std::int64_t seen = -1; !stop_.Wait(interval);) {
          RunTask([&live] { live.CatchUp(); });
          RunTask(tasks.always);
          const std::int64_t now = live.snapshot()->revision;
          if (now == seen) RunTask(tasks.when_idle);
          seen = now;
        }
      }) {}

IdleTask::~IdleTask() {
  stop_.Raise();
  thread_.join();
}

}  // namespace graspdb::server
