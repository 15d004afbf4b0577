// Health of the server (grpc.health.v1), and of the service "graspdb.writes".
#pragma once

#include <grpcpp/server.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <thread>

#include "program/base/stop_flag.h"
#include "server/live/live_catalogue.h"
#include "storage/catalogue/catalogue.h"

namespace graspdb::server {

// Reports SERVING while `live` agrees with the catalogue on the disk, else NOT_SERVING.
class Health {
 public:
  // Both must outlive this; `server` was built with gRPC's health service.
  Health(LiveCatalogue& live, grpc::Server& server);
  ~Health();
  Health(const Health&) = delete;
  Health& operator=(const Health&) = delete;

  // Reports NOT_SERVING from now on.
  void Drain();

 private:
  LiveCatalogue& live_;
  grpc::Server& server_;
};

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
