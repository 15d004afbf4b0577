// Work beside the requests: catching up, and tasks, of which one waits until the catalogue is idle.
#pragma once

#include <chrono>
#include <functional>
#include <thread>

#include "program/base/stop_flag.h"
#include "server/live/live_catalogue.h"

namespace graspdb::server {

// A thread of low priority (LowerPriority) that calls CatchUp() on the live catalogue every 10 s,
// and then the tasks.
class IdleTask {
 public:
  // An exception, such as std::bad_alloc, is logged and ends that run only.
  struct Tasks {
    // Each time: robots that report their picks change the catalogue every few seconds, day and
    // night.
    std::function<void()> always = {};
    std::function<void()> when_idle = {};  // if the catalogue has not changed since the last time
  };

  // `live` must outlive this. With a shorter interval a catalogue counts as idle earlier.
  IdleTask(LiveCatalogue& live, Tasks tasks,
           std::chrono::nanoseconds interval = std::chrono::seconds(10));
  // Waits for a task that is running.
  ~IdleTask();
  IdleTask(const IdleTask&) = delete;
  IdleTask& operator=(const IdleTask&) = delete;

 private:
  StopFlag stop_;
  std::thread thread_;
};

}  // namespace graspdb::server
