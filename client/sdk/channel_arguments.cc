#include "client/sdk/channel_arguments.h"

#include "program/connections/proxy.h"

namespace graspdb::client {
namespace {

// The first delay between two attempts to connect, and the longest, to which it grows by 1.6 with
// each. gRPC's own 120 s keep a cell without a server for up to 2 minutes after that is back.
constexpr int kFirstReconnectMs = 100;
constexpr int kLongestReconnectMs = 1'000;
// For an attempt: TCP, TLS, and the server's first HTTP/2 frame. TCP repeats a lost packet after 1
// and 3 s, so a cable that is plugged in is noticed after 2 s at the latest. In spite of its name
// the option is not a minimum of the delay.
constexpr int kConnectMs = 4'000;
// Milliseconds without a message during a call after which the server gets a ping, at least 10 s
// (server/builder_settings.cc), and after which the connection is closed if the ping or sent data
// are not acknowledged (TCP_USER_TIMEOUT). Without, TCP repeats data up to 2 minutes after the
// power is back at the server.
constexpr int kClientKeepaliveMs = 20'000;
constexpr int kClientKeepaliveTimeoutMs = 10'000;

}  // namespace

grpc::ChannelArguments ChannelArgumentsFor(const std::string& server) {
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, kFirstReconnectMs);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, kLongestReconnectMs);
  arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, kConnectMs);
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIME_MS, kClientKeepaliveMs);
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, kClientKeepaliveTimeoutMs);
  if (IsLocalTarget(server)) arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
  arguments.SetMaxReceiveMessageSize(-1);
  arguments.SetMaxSendMessageSize(-1);
  return arguments;
}

}  // namespace graspdb::client
