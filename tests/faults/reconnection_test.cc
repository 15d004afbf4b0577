// A client whose server is away for some time: each in a process of its own, as gRPC reads a
// client's sockets in the threads of any server in the same process.
#include <gtest/gtest.h>

#include <csignal>
#include <memory>
#include <string>
#include <vector>

#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "tests/faults/fault_fixture.h"
#include "tests/testing/certificates.h"

namespace graspdb::faults {
namespace {

class ReconnectionTest : public FaultTest {
 protected:
  // Kills the server, and starts it again some calls later at the same address.
  void ExpectReachedAgain(client::Client client, const std::vector<std::string>& flags) {
    ASSERT_EQ(client.GetCatalogStatus().status(), absl::OkStatus());
    server_->Signal(SIGKILL);
    server_->Wait();
    EXPECT_FALSE(IsReachedWithin(client, absl::Seconds(3)));
    std::vector<std::string> command = ServerCommand(Path("db"), address_);
    command.insert(command.end(), flags.begin(), flags.end());
    server_ = std::make_unique<end_to_end::Process>(folder_.path(), command);
    ASSERT_EQ(server_->WaitForLine("listening on "), address_) << server_->Errors();
    // About a second; with TLS and without Reconnection more than 50.
    EXPECT_TRUE(IsReachedWithin(client, absl::Seconds(30)));
  }
  // Calls one after the other, as a cell does: none waits for the server.
  static bool IsReachedWithin(client::Client& client, absl::Duration time) {
    const absl::Time end = absl::Now() + time;
    while (absl::Now() < end) {
      if (client.GetCatalogStatus().ok()) return true;
      absl::SleepFor(absl::Milliseconds(20));
    }
    return false;
  }
};

TEST_F(ReconnectionTest, AServerIsReachedAgain) {
  StartServer();
  ExpectReachedAgain(client::Client({.server = address_, .retry = false}), {});
}

TEST_F(ReconnectionTest, AServerWithTlsIsReachedAgain) {
  const testing::Authority plant("plant");
  const testing::KeyPair pair = plant.IssueForLoopback();
  const std::vector<std::string> flags = {
      "--tls-cert", folder_.Write("server.pem", pair.certificate).string(), "--tls-key",
      folder_.Write("server.key", pair.key).string()};
  StartServer("db", flags);
  const std::string ca = folder_.Write("plant.pem", plant.certificate()).string();
  ExpectReachedAgain(client::Client({.server = address_, .retry = false, .security = {.ca = ca}}),
                     flags);
}

}  // namespace
}  // namespace graspdb::faults
