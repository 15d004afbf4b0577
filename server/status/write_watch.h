// Whether changes of the catalogue succeed.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <thread>

#include "program/base/stop_flag.h"
#include "storage/catalogue/catalogue.h"

namespace graspdb::server {

// Service name of grpc.health.v1: SERVING while changes succeed. The server as a whole is SERVING
// also without them, since frames are recognised.
inline constexpr char kWritesHealth[] = "graspdb.writes";

// A thread that calls CheckWrites() on the catalogue each second, so that changes succeed again
// once a fault is gone, and logs and reports the beginning and the end of a fault.
class WriteWatch {
 public:
  // `catalogue` must outlive this. `report` is called on the thread, at first for the first result.
  WriteWatch(storage::Catalogue& catalogue, std::function<void(bool succeed)> report,
             std::chrono::nanoseconds interval = std::chrono::seconds(1));
  ~WriteWatch();
  WriteWatch(const WriteWatch&) = delete;
  WriteWatch& operator=(const WriteWatch&) = delete;

 private:
  std::atomic<bool> cancelled_ = false;
  StopFlag stop_;
  std::thread thread_;
};

}  // namespace graspdb::server
