#include "client/cell/agent/counters_log.h"

#include <spdlog/spdlog.h>

#include <utility>

namespace graspdb::client {

CountersLog::CountersLog(std::function<std::string()> text, absl::Duration period)
    : text_(std::move(text)), period_(period), thread_([this] { Run(); }) {}

CountersLog::~CountersLog() {
  stop_.Raise();
  thread_.join();
}

void CountersLog::Run() {
  for (bool last = false; !last;) {
    last = stop_.Wait(absl::ToChronoNanoseconds(period_));
    spdlog::info("event=counters {}", text_());
  }
}

}  // namespace graspdb::client
