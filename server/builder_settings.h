// Settings of the gRPC server to be built.
#pragma once

#include <grpcpp/impl/server_builder_option.h>
#include <grpcpp/impl/server_builder_plugin.h>
#include <grpcpp/server_builder.h>

#include <memory>
#include <vector>

namespace graspdb::server {

// The server to be built closes connections whose client does not answer a ping (within 50 s) and
// those that do not begin with HTTP/2 (within 20 s), and accepts pings of its clients every 10 s.
void EndDeadConnections(grpc::ServerBuilder& builder);

// Leaves out server reflection, which its library adds to every server of the process.
class NoReflection : public grpc::ServerBuilderOption {
 public:
  void UpdateArguments(grpc::ChannelArguments* /*arguments*/) override {}
  void UpdatePlugins(std::vector<std::unique_ptr<grpc::ServerBuilderPlugin>>* plugins) override {
    std::erase_if(*plugins, [](const std::unique_ptr<grpc::ServerBuilderPlugin>& plugin) {
      return plugin->name() == "proto_server_reflection";
    });
  }
};

}  // namespace graspdb::server
