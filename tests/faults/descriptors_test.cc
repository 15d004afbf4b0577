// A server whose file descriptors are used up.
#include <gmock/gmock.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tests/faults/fault_fixture.h"
#include "tests/faults/silent_connection.h"
#include "tests/program/loopback_connection.h"

namespace graspdb::faults {
namespace {

using ::testing::HasSubstr;

// A server that may open this many files.
constexpr int kFewDescriptors = 128;

class FewDescriptorsTest : public FaultTest {
 protected:
  void StartLimited(const std::string& limit) {
    std::vector<std::string> command = ServerCommand(Path("db"), "127.0.0.1:0");
    command.insert(command.begin(),
                   {"/bin/sh", "-c", "ulimit -n " + limit + " && exec \"$@\"", "sh"});
    server_ = std::make_unique<end_to_end::Process>(folder_.path(), command);
    address_ = server_->WaitForLine("listening on ");
  }
};

TEST_F(FewDescriptorsTest, ConnectionsAreAcceptedAgainAfterAllDescriptorsWereInUse) {
  StartLimited(std::to_string(kFewDescriptors));
  client::Client before = Connect();
  ASSERT_TRUE(before.GetCatalogStatus().ok());
  {
    std::vector<std::unique_ptr<SilentConnection>> silent;
    silent.reserve(std::size_t{2} * kFewDescriptors);
    for (int i = 0; i < 2 * kFewDescriptors; ++i) {
      silent.push_back(std::make_unique<SilentConnection>(address_, ""));
    }
    EXPECT_TRUE(before.GetCatalogStatus().ok());
  }
  absl::Status status = Connect().GetCatalogStatus().status();
  const auto limit = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  while (!status.ok() && std::chrono::steady_clock::now() < limit) {
    status = Connect().GetCatalogStatus().status();
  }
  EXPECT_EQ(status, absl::OkStatus());
  EXPECT_TRUE(server_->WaitForError("event=connections_refused"));
  EXPECT_TRUE(server_->WaitForError("open_files_limit=128"));
}

// Connections from there which the server takes, until it closes one.
int CountTaken(const std::string& server, std::uint32_t from, std::vector<FileDescriptor>& taken) {
  const auto port = static_cast<std::uint16_t>(std::stoi(server.substr(server.rfind(':') + 1)));
  int count = 0;
  for (char first = 0;; ++count) {
    taken.push_back(testing::ConnectTo(port, from));
    if (recv(taken.back().number(), &first, sizeof(first), 0) != sizeof(first)) return count;
  }
}

TEST_F(FewDescriptorsTest, OneAddressLeavesHalfOfTheConnectionsToOthers) {
  StartLimited(std::to_string(kFewDescriptors));
  std::vector<FileDescriptor> taken;
  const int one = CountTaken(address_, testing::kOneAddress, taken);
  const int another = CountTaken(address_, testing::kAnotherAddress, taken);
  EXPECT_GT(one, 0);
  constexpr int kFilesMeanwhile = 4;
  EXPECT_GE(another, one - kFilesMeanwhile);
}

TEST_F(FewDescriptorsTest, TooFewToWorkWithAreAnErrorAtTheStart) {
  StartLimited("32");
  const end_to_end::Finished ended = server_->Wait();
  EXPECT_EQ(ended.exit_status, 1);
  EXPECT_THAT(ended.err, HasSubstr("the limit of 32 open files is too low"));
}

}  // namespace
}  // namespace graspdb::faults
