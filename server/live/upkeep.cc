#include "server/live/upkeep.h"

#include <spdlog/spdlog.h>

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
  spdlog::error("event=upkeep_failed error={}", LogField(std::string(done.message())));
}

}  // namespace

Upkeep::Upkeep(LiveCatalogue& live, std::function<void()> task, std::chrono::nanoseconds interval)
    : thread_([this, &live, task = std::move(task), interval] {
        LowerPriority();
        while (!stop_.Wait(interval)) {
          RunTask([&live] { live.CatchUp(); });
          RunTask(task);
        }
      }) {}

Upkeep::~Upkeep() {
  stop_.Raise();
  thread_.join();
}

}  // namespace graspdb::server
