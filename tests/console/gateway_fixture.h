// A gateway before a real server.
#pragma once

#include <google/protobuf/util/json_util.h>

#include <memory>
#include <string>
#include <vector>

#include "console/gateway.h"
#include "console/grpc_upstream.h"
#include "tests/console/http_client.h"
#include "tests/console/sample_page.h"
#include "tests/server/server_fixture.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::testing {

inline constexpr char kJson[] = "application/json";
inline constexpr char kProto[] = "application/proto";
inline constexpr char kJsonStream[] = "application/connect+json";
inline constexpr char kProtoStream[] = "application/connect+proto";

// Base: ServerTest, or a fixture derived from it.
template <typename Base>
class ConsoleTest : public Base {
 protected:
  // To be called after the server's start.
  void StartGateway(const client::SecurityOptions& security = {}) {
    StartGateway(std::make_unique<console::GrpcUpstream>(client::ConnectionOptions{
        .server = this->server_->address(), .own_connection = true, .security = security}));
  }
  void StartGateway(std::unique_ptr<console::Upstream> upstream) {
    gateway_.reset();
    auto gateway = console::Gateway::Start(gateway_options_, kSamplePage, std::move(upstream));
    ASSERT_THAT(gateway, IsOk());
    gateway_ = *std::move(gateway);
  }
  HttpClient Connect() const { return HttpClient(gateway_->port()); }
  // A call on a connection of its own.
  HttpResponse Call(const std::string& method, const std::string& type, const std::string& body,
                    const HttpFields& fields = {}) const {
    return Connect().Call("/graspdb.v1." + method, type, body, fields);
  }

  console::GatewayOptions gateway_options_ = {.listen = "127.0.0.1:0"};
  std::unique_ptr<console::Gateway> gateway_;
};

inline std::string JsonOf(const google::protobuf::Message& message) {
  std::string out;
  EXPECT_TRUE(google::protobuf::util::MessageToJsonString(message, &out).ok());
  return out;
}

// The messages of a streamed body, with their flags.
struct StreamMessage {
  int flags = 0;
  std::string bytes;
};
inline std::vector<StreamMessage> MessagesOf(const std::string& body) {
  std::vector<StreamMessage> out;
  std::size_t at = 0;
  while (at + 5 <= body.size()) {
    std::size_t size = 0;
    for (std::size_t i = 1; i < 5; ++i) size = size << 8 | static_cast<unsigned char>(body[at + i]);
    out.push_back({static_cast<unsigned char>(body[at]), body.substr(at + 5, size)});
    at += 5 + size;
  }
  EXPECT_EQ(at, body.size()) << "a whole number of envelopes";
  return out;
}

}  // namespace graspdb::testing
