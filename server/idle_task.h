// Work beside the requests: catching up, and a task while the catalogue is idle.
#pragma once

#include <functional>
#include <thread>

#include "program/stop_flag.h"
#include "server/live_catalogue.h"

namespace graspdb::server {

// A thread of low priority (LowerPriority) that calls CatchUp() on the live catalogue every 10 s,
// and then `task` if the catalogue has not changed meanwhile.
class IdleTask {
 public:
  // `live` must outlive this, and `task` must not throw.
  IdleTask(LiveCatalogue& live, std::function<void()> task);
  // Waits for `task` if it is running.
  ~IdleTask();
  IdleTask(const IdleTask&) = delete;
  IdleTask& operator=(const IdleTask&) = delete;

 private:
  StopFlag stop_;
  std::thread thread_;
};

}  // namespace graspdb::server
