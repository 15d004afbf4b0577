#include "program/connections/connection_watch.h"

#include <gmock/gmock.h>
#include <poll.h>

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "program/connections/listening_sockets.h"
#include "program/connections/peer_address.h"
#include "tests/program/loopback_connection.h"
#include "tests/testing/status_matchers.h"

namespace graspdb {
namespace {

using graspdb::testing::ConnectTo;
using graspdb::testing::IsOk;
using graspdb::testing::kAnotherAddress;
using graspdb::testing::kOneAddress;

constexpr int kAbandonedCalls = 80;
constexpr std::size_t kMemoryBytes = 1000;
constexpr std::size_t kMessageBytes = 3U << 20U;

class ConnectionWatchTest : public ::testing::Test {
 protected:
  // Both ends of a connection.
  struct Connection {
    FileDescriptor client;
    FileDescriptor server;
    std::string peer;
  };

  void SetUp() override {
    auto listening = ListenAt({"127.0.0.1", 0});
    ASSERT_THAT(listening, IsOk());
    listening_ = *std::move(listening);
  }
  Connection Connect(std::uint32_t from = kOneAddress) {
    Connection out;
    out.client = ConnectTo(listening_.port, from);
    const int listener = listening_.sockets.front().number();
    pollfd event = {listener, POLLIN, 0};
    poll(&event, 1, -1);
    out.server = FileDescriptor(accept4(listener, nullptr, nullptr, SOCK_CLOEXEC));
    out.peer = PeerOf(out.server.number());
    return out;
  }
  bool Add(const Connection& connection) {
    return watch_.Add(connection.server.number(), connection.peer, now_);
  }
  Connection ConnectAndAdd(std::uint32_t from = kOneAddress) {
    Connection out = Connect(from);
    EXPECT_TRUE(Add(out));
    return out;
  }
  std::vector<Connection> ConnectAndAddMany() {
    constexpr std::size_t kMany = 100;
    std::vector<Connection> out;
    out.reserve(kMany);
    while (out.size() < kMany) out.push_back(ConnectAndAdd());
    return out;
  }
  void Check() {
    now_ += std::chrono::milliseconds(200);
    watch_.Check(now_);
  }
  void Abandon(const Connection& connection, int calls) {
    for (int i = 0; i < calls; ++i) watch_.NoteAbandoned(connection.peer, now_);
  }
  // As often as makes a flood of `connections`, all of one address.
  void Flood(const std::vector<const Connection*>& connections) {
    const int most = kAbandonedCalls + 8 * static_cast<int>(connections.size() + 1);
    for (int i = 0; i <= most; ++i) {
      Abandon(*connections[static_cast<std::size_t>(i) % connections.size()], 1);
    }
  }
  // The server has received them when it returns.
  static void Send(const Connection& connection, std::size_t bytes) {
    std::vector<char> block(std::size_t{1} << 16U);
    for (std::size_t sent = 0; sent < bytes; sent += block.size()) {
      ASSERT_EQ(send(connection.client.number(), block.data(), block.size(), 0), std::ssize(block));
      ASSERT_EQ(recv(connection.server.number(), block.data(), block.size(), MSG_WAITALL),
                std::ssize(block));
    }
  }
  static bool IsEnded(const Connection& connection) {
    char byte = 0;
    return recv(connection.client.number(), &byte, 1, MSG_DONTWAIT) == 0;
  }

  std::size_t memory_ = 2 * kMemoryBytes;
  ConnectionWatch watch_{{.abandoned_calls = kAbandonedCalls,
                          .memory_bytes = kMemoryBytes,
                          .message_bytes = kMessageBytes},
                         [this] { return memory_; }};
  ConnectionWatch::Clock::time_point now_ = ConnectionWatch::Clock::now();
  ListeningSockets listening_;
};

TEST_F(ConnectionWatchTest, AFloodOfAbandonedCallsEndsItsConnection) {
  const Connection flood = ConnectAndAdd();
  const Connection honest = ConnectAndAdd();
  const Connection other = ConnectAndAdd(kAnotherAddress);
  Abandon(other, kAbandonedCalls);
  Abandon(honest, 1);
  EXPECT_FALSE(IsEnded(flood));
  Flood({&flood});
  EXPECT_TRUE(IsEnded(flood));
  EXPECT_FALSE(IsEnded(honest));
  EXPECT_FALSE(IsEnded(other));
  EXPECT_EQ(watch_.ended_count(), 1);
  Flood({&flood});  // what gRPC still has of it
  EXPECT_EQ(watch_.ended_count(), 1);
}

TEST_F(ConnectionWatchTest, AnAddressThatFloodedWaitsUntilItConnectsAgain) {
  const Connection flood = ConnectAndAdd();
  Flood({&flood});
  EXPECT_FALSE(Add(Connect()));
  ConnectAndAdd(kAnotherAddress);
  now_ += std::chrono::seconds(11);
  ConnectAndAdd();
}

TEST_F(ConnectionWatchTest, AFloodOverManyConnectionsEndsThemAll) {
  const std::vector<Connection> flood = ConnectAndAddMany();
  const Connection honest = ConnectAndAdd();
  Abandon(honest, 1);
  std::vector<const Connection*> all;
  all.reserve(flood.size());
  for (const Connection& connection : flood) all.push_back(&connection);
  Flood(all);
  for (const Connection& connection : flood) EXPECT_TRUE(IsEnded(connection));
  EXPECT_FALSE(IsEnded(honest));
}

TEST_F(ConnectionWatchTest, ManyCellsBehindOneAddressMayGiveUpAtOnce) {
  const std::vector<Connection> cells = ConnectAndAddMany();
  for (const Connection& cell : cells) Abandon(cell, 8);
  for (const Connection& cell : cells) EXPECT_FALSE(IsEnded(cell));
}

TEST_F(ConnectionWatchTest, CallsThatAreAbandonedNowAndThenEndNothing) {
  const Connection connection = ConnectAndAdd();
  for (int second = 0; second < 5; ++second) {
    Abandon(connection, kAbandonedCalls);
    now_ += std::chrono::seconds(1);
  }
  EXPECT_FALSE(IsEnded(connection));
}

TEST_F(ConnectionWatchTest, WithoutMemoryTheConnectionThatReceivesMostIsEnded) {
  const Connection flood = ConnectAndAdd();
  const Connection robot = ConnectAndAdd();
  Check();
  Send(flood, 2 * kMessageBytes);
  Send(robot, 2 * kMessageBytes + kMessageBytes / 2);
  watch_.NoteMessage(robot.peer);
  Check();
  EXPECT_TRUE(IsEnded(flood));
  EXPECT_FALSE(IsEnded(robot));
  EXPECT_FALSE(Add(Connect()));
}

TEST_F(ConnectionWatchTest, WithoutMemoryASlowConnectionIsEndedAfterAWhile) {
  const Connection flood = ConnectAndAdd();
  Check();
  Send(flood, kMessageBytes);
  Check();
  EXPECT_FALSE(IsEnded(flood)) << "it may be a message";
  now_ += std::chrono::seconds(6);
  Check();
  EXPECT_TRUE(IsEnded(flood));
}

TEST_F(ConnectionWatchTest, WithoutMemoryTheConnectionWithMostCallsIsEnded) {
  const Connection flood = ConnectAndAdd();
  const Connection robot = ConnectAndAdd();
  Check();
  for (int i = 0; i < 1000; ++i) watch_.NoteMessage(flood.peer);
  for (int i = 0; i < 100; ++i) watch_.NoteMessage(robot.peer);
  Send(robot, 2 * kMessageBytes);
  Check();
  EXPECT_TRUE(IsEnded(flood));
  EXPECT_FALSE(IsEnded(robot));
}

TEST_F(ConnectionWatchTest, WithMemoryNothingIsEnded) {
  memory_ = kMemoryBytes;
  const Connection connection = ConnectAndAdd();
  Check();
  Send(connection, 2 * kMessageBytes);
  now_ += std::chrono::seconds(6);
  Check();
  EXPECT_FALSE(IsEnded(connection));
}

TEST_F(ConnectionWatchTest, AnotherConnectionOfTheDescriptorIsNotEnded) {
  Connection flood = ConnectAndAdd();
  const std::string peer = flood.peer;
  const int descriptor = flood.server.number();
  flood.client.Close();
  flood.server.Close();
  const Connection next = Connect();
  ASSERT_TRUE(next.server.number() == descriptor || next.client.number() == descriptor);
  for (int i = 0; i < 10 * kAbandonedCalls; ++i) watch_.NoteAbandoned(peer, now_);
  EXPECT_FALSE(IsEnded(next));
  EXPECT_EQ(watch_.ended_count(), 0);
}

}  // namespace
}  // namespace graspdb
