// Connecting to a server that is slow or away.
#include <arpa/inet.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <grpcpp/server_builder.h>
#include <grpcpp/server_posix.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/synchronization/notification.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "client/sdk/client.h"
#include "graspdb/v1/catalog_service.grpc.pb.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using testing::IsOk;
using testing::StatusIs;

// Calls a function, on a thread, with the descriptor of each TCP connection; the function owns it.
class Listener {
 public:
  explicit Listener(std::function<void(int)> accepted)
      : socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    EXPECT_EQ(bind(socket_, reinterpret_cast<sockaddr*>(&address), size), 0);
    EXPECT_EQ(listen(socket_, SOMAXCONN), 0);
    EXPECT_EQ(getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size), 0);
    address_ = absl::StrCat("127.0.0.1:", ntohs(address.sin_port));
    thread_ = std::thread([this, accepted = std::move(accepted)] {
      for (int one = 0; (one = accept4(socket_, nullptr, nullptr, SOCK_CLOEXEC)) >= 0;) {
        accepted(one);
      }
    });
  }
  ~Listener() {
    shutdown(socket_, SHUT_RDWR);
    thread_.join();
    close(socket_);
  }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  const std::string& address() const { return address_; }

 private:
  const int socket_;
  std::string address_;
  std::thread thread_;
};

// Its catalogue is empty.
class EmptyServer : public v1::CatalogService::Service {
  grpc::Status GetCatalogStatus(grpc::ServerContext*, const v1::GetCatalogStatusRequest*,
                                v1::CatalogStatus*) override {
    return grpc::Status::OK;
  }
};

TEST(ConnectionTest, AServerThatTakesASecondIsReached) {
  EmptyServer service;
  const std::unique_ptr<grpc::Server> server =
      grpc::ServerBuilder().RegisterService(&service).BuildAndStart();
  const Listener slow([&](int connection) {
    absl::SleepFor(absl::Seconds(1));
    fcntl(connection, F_SETFL, O_NONBLOCK);
    grpc::AddInsecureChannelFromFd(server.get(), connection);
  });
  EXPECT_THAT(Client({.server = slow.address()}).GetCatalogStatus(), IsOk());
}

TEST(ConnectionTest, ServersThatAreAwayForLongAreTriedAsOften) {
  // gRPC's own delay, which grows by 1.6 with each attempt, is 9 to 13 s before the last one.
  constexpr int kAttempts = 12;
  absl::Notification last;
  int attempts = 0;
  absl::Time before;
  absl::Duration longest;
  const Listener absent([&](int connection) {
    close(connection);
    if (attempts == kAttempts) return;
    const absl::Time now = absl::Now();
    if (attempts > 0) longest = std::max(longest, now - before);
    before = now;
    if (++attempts == kAttempts) last.Notify();
  });
  Client client({.server = absent.address(), .retry = false});
  const absl::Time end = absl::Now() + absl::Seconds(100);
  while (!last.HasBeenNotified() && absl::Now() < end) {
    ASSERT_THAT(client.GetCatalogStatus(), StatusIs(absl::StatusCode::kUnavailable));
    absl::SleepFor(absl::Milliseconds(20));
  }
  ASSERT_TRUE(last.HasBeenNotified());
  EXPECT_LT(longest, absl::Seconds(6));
}

TEST(ConnectionTest, AServerWithoutAnAnswerIsUnreachableAndNotSlow) {
  const Listener silent([](int) {});  // connections stay open until the program ends
  Client client({.server = silent.address(), .timeout = absl::Milliseconds(300)});
  EXPECT_THAT(client.GetCatalogStatus(),
              StatusIs(absl::StatusCode::kUnavailable,
                       ::testing::HasSubstr("no graspdb server is reachable")));
}

}  // namespace
}  // namespace graspdb::client
