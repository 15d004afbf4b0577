// Periodic counters in the log.
#pragma once

#include <functional>
#include <string>
#include <thread>

#include "absl/time/time.h"
#include "program/base/stop_flag.h"

namespace graspdb::client {

// Logs `text` every `period`, and once more at destruction, on its own thread.
class CountersLog {
 public:
  CountersLog(std::function<std::string()> text, absl::Duration period);
  ~CountersLog();
  CountersLog(const CountersLog&) = delete;
  CountersLog& operator=(const CountersLog&) = delete;

 private:
  void Run();

  const std::function<std::string()> text_;
  const absl::Duration period_;
  StopFlag stop_;
  std::thread thread_;
};

}  // namespace graspdb::client
