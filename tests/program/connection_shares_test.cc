#include "program/connections/connection_shares.h"

#include <gmock/gmock.h>
#include <poll.h>

#include <chrono>
#include <thread>

#include "program/connections/listening_sockets.h"
#include "tests/program/loopback_connection.h"
#include "tests/testing/status_matchers.h"

namespace graspdb {
namespace {

using graspdb::testing::ConnectTo;
using graspdb::testing::IsOk;
using graspdb::testing::kAnotherAddress;
using graspdb::testing::kOneAddress;

// A listener, and both ends of its connections.
class ConnectionSharesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto listening = ListenAt({"127.0.0.1", 0});
    ASSERT_THAT(listening, IsOk());
    listening_ = *std::move(listening);
  }
  // Whether the shares have room for a connection from there; it is closed if not.
  bool Adds(std::uint32_t address) {
    clients_.push_back(ConnectTo(listening_.port, address));
    const int listener = listening_.sockets.front().number();
    pollfd event = {listener, POLLIN, 0};
    poll(&event, 1, -1);
    accepted_.emplace_back(accept4(listener, nullptr, nullptr, SOCK_CLOEXEC));
    if (shares_.Add(accepted_.back().number())) return true;
    accepted_.pop_back();
    return false;
  }
  int CountAdded(std::uint32_t address) {
    int count = 0;
    while (Adds(address)) ++count;
    return count;
  }

  int files_ = 10;
  ConnectionShares shares_{17, [this] { return files_ + static_cast<int>(accepted_.size()); }};
  ListeningSockets listening_;
  std::vector<FileDescriptor> clients_;
  std::vector<FileDescriptor> accepted_;
};

TEST_F(ConnectionSharesTest, AnAddressHasItsShareWhateverOthersHave) {
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(Adds(kOneAddress));
  EXPECT_FALSE(Adds(kOneAddress));
  EXPECT_TRUE(Adds(kAnotherAddress));
  EXPECT_FALSE(Adds(kOneAddress));
}

TEST_F(ConnectionSharesTest, AnAddressHasHalfOfWhatFilesLeave) {
  files_ = 4;
  EXPECT_EQ(CountAdded(kOneAddress), 6);
  EXPECT_EQ(CountAdded(kAnotherAddress), 6);
}

TEST_F(ConnectionSharesTest, ClosedConnectionsLeaveTheirPlace) {
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(Adds(kOneAddress));
  // The number of one is a file's then.
  ASSERT_GE(dup2(listening_.sockets.front().number(), accepted_.front().number()), 0);
  while (!Adds(kOneAddress)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_FALSE(Adds(kOneAddress));
  accepted_.clear();
  for (int i = 0; i < 3; ++i) {
    while (!Adds(kOneAddress)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_FALSE(Adds(kOneAddress));
}

}  // namespace
}  // namespace graspdb
