// Health of the server (grpc.health.v1).
#pragma once

#include <grpcpp/server.h>

#include "server/live/live_catalogue.h"

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

}  // namespace graspdb::server
