// A server with an empty catalogue, in the process of the test.
#pragma once

#include <spdlog/spdlog.h>

#include <memory>
#include <string>

#include "client/sdk/client.h"
#include "server/server.h"
#include "tests/files/temporary_folder.h"

namespace graspdb::testing {

// Goes with its folder. Silences the log.
class CatalogueServer {
 public:
  CatalogueServer() {
    spdlog::set_level(spdlog::level::off);
    server::ServerOptions options;
    options.database = (folder_.path() / "db").string();
    options.listen = "127.0.0.1:0";
    server_ = server::Server::Start(options).value();  // without it there is nothing to test
    client_ =
        std::make_unique<client::Client>(server_->InProcessChannel(), client::ConnectionOptions());
  }

  client::Client& client() { return *client_; }
  // HOST:PORT, for programs.
  const std::string& address() const { return server_->address(); }

 private:
  files::TemporaryFolder folder_;
  std::unique_ptr<server::Server> server_;
  std::unique_ptr<client::Client> client_;
};

}  // namespace graspdb::testing
