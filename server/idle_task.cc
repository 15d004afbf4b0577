#include "server/idle_task.h"

#include <chrono>
#include <cstdint>
#include <utility>

#include "server/background.h"

namespace graspdb::server {
namespace {

constexpr std::chrono::seconds kPollInterval{10};

}  // namespace

IdleTask::IdleTask(LiveCatalogue& live, std::function<void()> task)
    : thread_([this, &live, task = std::move(task)] {
        LowerPriority();
        for (std::int64_t seen = -1; !stop_.Wait(kPollInterval);) {
          live.CatchUp();
          const std::int64_t now = live.snapshot()->revision;
          if (now == seen) task();
          seen = now;
        }
      }) {}

IdleTask::~IdleTask() {
  stop_.Raise();
  thread_.join();
}

}  // namespace graspdb::server
