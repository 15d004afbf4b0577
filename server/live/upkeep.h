// Work beside the requests.
#pragma once

#include <chrono>
#include <functional>
#include <thread>

#include "program/base/stop_flag.h"
#include "server/live/live_catalogue.h"

namespace graspdb::server {

// A thread of low priority (LowerPriority) that calls CatchUp() on the live catalogue every 10 s,
// and then `task`. An exception of either, such as std::bad_alloc, is logged and ends that run
// only.
class Upkeep {
 public:
  // `live` must outlive this.
  Upkeep(LiveCatalogue& live, std::function<void()> task,
         std::chrono::nanoseconds interval = std::chrono::seconds(10));
  // Waits for a task that is running.
  ~Upkeep();
  Upkeep(const Upkeep&) = delete;
  Upkeep& operator=(const Upkeep&) = delete;

 private:
  StopFlag stop_;
  std::thread thread_;
};

}  // namespace graspdb::server
