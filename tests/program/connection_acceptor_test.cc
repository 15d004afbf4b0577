#include "program/connections/connection_acceptor.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <grpcpp/generic/async_generic_service.h>
#include <grpcpp/server.h>
#include <netdb.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>

#include <array>
#include <chrono>
#include <string_view>
#include <thread>

#include "tests/program/loopback_connection.h"
#include "tests/testing/status_matchers.h"

namespace graspdb {
namespace {

using graspdb::testing::Connects;
using graspdb::testing::ConnectTo;
using graspdb::testing::IsOk;
using graspdb::testing::kOneAddress;
using graspdb::testing::StatusIs;
using ::testing::HasSubstr;

constexpr int kFrameHeaderBytes = 9;  // of HTTP/2

// A bare container may have no /etc/hosts.
bool KnowsLocalhost() {
  addrinfo* found = nullptr;
  if (getaddrinfo("localhost", nullptr, nullptr, &found) != 0) return false;
  freeaddrinfo(found);
  return true;
}

// Whether the server begins with HTTP/2, and does not close the connection.
bool IsAnswered(const FileDescriptor& connection) {
  std::array<char, kFrameHeaderBytes> header{};
  return recv(connection.number(), header.data(), header.size(), MSG_WAITALL) == kFrameHeaderBytes;
}

// The soft limit of descriptors, until the end of the test.
class OwnDescriptorLimit {
 public:
  OwnDescriptorLimit() { getrlimit(RLIMIT_NOFILE, &before_); }
  ~OwnDescriptorLimit() { Restore(); }
  OwnDescriptorLimit(const OwnDescriptorLimit&) = delete;
  OwnDescriptorLimit& operator=(const OwnDescriptorLimit&) = delete;

  void Set(rlim_t soft) const {
    const rlimit limit = {soft, before_.rlim_max};
    ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &limit), 0);
  }
  void Restore() const { setrlimit(RLIMIT_NOFILE, &before_); }

 private:
  rlimit before_{};
};

// A gRPC server without services.
class ConnectionAcceptorTest : public ::testing::Test {
 protected:
  void SetUp() override { spdlog::set_level(spdlog::level::off); }
  void TearDown() override {
    if (acceptor_ != nullptr) acceptor_->Stop();
    if (server_ != nullptr) server_->Shutdown();
    server_.reset();
  }

  void Listen(const std::string& host) {
    auto acceptor = ConnectionAcceptor::Listen({host, 0});
    ASSERT_THAT(acceptor, IsOk());
    acceptor_ = *std::move(acceptor);
    grpc::ServerBuilder builder;
    acceptor_->AddTo(builder, grpc::InsecureServerCredentials());
    no_calls_ = std::make_unique<grpc::CallbackGenericService>();
    builder.RegisterCallbackGenericService(no_calls_.get());
    server_ = builder.BuildAndStart();
    ASSERT_NE(server_, nullptr);
    acceptor_->Start();
  }
  std::uint16_t port() const { return acceptor_->port(); }

  std::unique_ptr<grpc::CallbackGenericService> no_calls_;  // gRPC does not start without a service
  std::unique_ptr<ConnectionAcceptor> acceptor_;
  std::unique_ptr<grpc::Server> server_;
};

TEST_F(ConnectionAcceptorTest, ListensAtEveryAddressOfAHost) {
  for (const char* host : {"127.0.0.1", "localhost", "0.0.0.0", "[::]"}) {
    SCOPED_TRACE(host);
    if (host == std::string_view("localhost") && !KnowsLocalhost()) continue;
    Listen(host);
    EXPECT_TRUE(IsAnswered(ConnectTo(port())));
    TearDown();
    EXPECT_FALSE(ConnectTo(port()).is_open());
  }
}

TEST_F(ConnectionAcceptorTest, APortInUseIsAnError) {
  Listen("127.0.0.1");
  for (const char* host : {"127.0.0.1", "0.0.0.0"}) {
    EXPECT_THAT(ConnectionAcceptor::Listen({host, port()}),
                StatusIs(absl::StatusCode::kUnavailable, HasSubstr("in use")));
  }
}

TEST_F(ConnectionAcceptorTest, AnAddressThatTheMachineLacksIsAnError) {
  for (const char* host : {"192.0.2.1", "[2001:db8::1]", "[not an address]"}) {
    EXPECT_THAT(ConnectionAcceptor::Listen({host, 0}), StatusIs(absl::StatusCode::kUnavailable))
        << host;
  }
}

TEST_F(ConnectionAcceptorTest, ConnectionsWithoutDescriptorAreClosedAndLaterOnesAccepted) {
  const OwnDescriptorLimit limit;
  Listen("127.0.0.1");
  EXPECT_TRUE(IsAnswered(ConnectTo(port())));
  {
    // The last one that may be open.
    const FileDescriptor connection(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    std::vector<FileDescriptor> taken;
    limit.Set(static_cast<rlim_t>(connection.number()) + 1);
    while (taken.empty() || taken.back().is_open()) {
      taken.emplace_back(open("/dev/null", O_RDONLY | O_CLOEXEC));
    }
    ASSERT_TRUE(Connects(connection, port()));
    EXPECT_FALSE(IsAnswered(connection));
    EXPECT_GE(acceptor_->refused_count(), 1);
  }
  limit.Restore();
  EXPECT_TRUE(IsAnswered(ConnectTo(port())));
}

TEST_F(ConnectionAcceptorTest, AQuarterOfTheDescriptorsIsKept) {
  const OwnDescriptorLimit limit;
  constexpr rlim_t kLimit = 128;
  limit.Set(kLimit);
  Listen("127.0.0.1");
  limit.Restore();
  std::vector<FileDescriptor> connections;
  connections.reserve(kLimit);
  for (std::uint32_t i = 0; acceptor_->refused_count() == 0 && i < kLimit; ++i) {
    connections.push_back(ConnectTo(port(), kOneAddress + i));
    if (!IsAnswered(connections.back())) break;
  }
  EXPECT_GE(acceptor_->refused_count(), 1);
  // Each takes two descriptors of this process.
  EXPECT_LE(2 * connections.size(), kLimit * 3 / 4 + 2);
  connections.clear();
  while (!IsAnswered(ConnectTo(port()))) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

}  // namespace
}  // namespace graspdb
