#include "server/builder_settings.h"

#include <grpc/grpc.h>

namespace graspdb::server {
namespace {

// Milliseconds after which a silent client gets a ping, and after which it is taken for gone: its
// connection is closed and its calls end. gRPC's own time is two hours.
constexpr int kServerKeepaliveMs = 30'000;
constexpr int kServerKeepaliveTimeoutMs = 20'000;
// Clients may send pings this often; gRPC's own five minutes are longer than the idle time of many
// routers.
constexpr int kMinPingMs = 10'000;
// For a new connection to begin with HTTP/2, after TLS if used. gRPC's own time is two minutes.
constexpr int kHandshakeMs = 20'000;

}  // namespace

void EndDeadConnections(grpc::ServerBuilder& builder) {
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, kServerKeepaliveMs);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, kServerKeepaliveTimeoutMs);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, kMinPingMs);
  builder.AddChannelArgument(GRPC_ARG_SERVER_HANDSHAKE_TIMEOUT_MS, kHandshakeMs);
}

}  // namespace graspdb::server
