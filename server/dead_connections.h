// Connections of clients that are gone.
#pragma once

#include <grpcpp/server_builder.h>

namespace graspdb::server {

// The server to be built closes connections whose client does not answer a ping (within 50 s) and
// those that do not begin with HTTP/2 (within 20 s), and accepts pings of its clients every 10 s.
void EndDeadConnections(grpc::ServerBuilder& builder);

}  // namespace graspdb::server
