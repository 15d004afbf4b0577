#include "client/cell/counters_log.h"

#include <spdlog/spdlog.h>

namespace graspdb::client {

CountersLog::CountersLog(const Counters& counters, absl::Duration period)
    : counters_(counters), period_(period), thread_([this] { Run(); }) {}

CountersLog::~CountersLog() {
  {
    absl::MutexLock lock(&mutex_);
    stopping_ = true;
  }
  thread_.join();
}

void CountersLog::Run() {
  for (bool last = false; !last;) {
    {
      absl::MutexLock lock(&mutex_);
      last = mutex_.AwaitWithTimeout(absl::Condition(&stopping_), period_);
    }
    spdlog::info("event=counters {}", counters_.Text());
  }
}

}  // namespace graspdb::client
