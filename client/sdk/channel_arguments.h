// How programs connect to a server.
#pragma once

#include <grpcpp/support/channel_arguments.h>

#include <string>

namespace graspdb::client {

// Reconnection, keepalive, proxy and message sizes of a channel to `server` (HOST:PORT); retries
// are the caller's. Thread-safe.
grpc::ChannelArguments ChannelArgumentsFor(const std::string& server);

}  // namespace graspdb::client
