// A reader of the log that does not read.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <csignal>

#include "program/connections/file_descriptor.h"
#include "tests/faults/fault_fixture.h"

namespace graspdb::faults {
namespace {

class LogReaderTest : public FaultTest {
 protected:
  // The server's log goes into a pipe, which is not read.
  void StartWithUnreadLog() {
    const std::string pipe = Path("log");
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    reader_ = FileDescriptor(open(pipe.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
    ASSERT_TRUE(reader_.is_open());
    std::vector<std::string> command = ServerCommand(Path("db"), "127.0.0.1:0");
    command.insert(command.begin(), {"/bin/sh", "-c", "exec \"$@\" 2>'" + pipe + "'", "sh"});
    server_ = std::make_unique<end_to_end::Process>(folder_.path(), command);
    address_ = server_->WaitForLine("listening on ");
  }

  FileDescriptor reader_;
};

TEST_F(LogReaderTest, CallsAreAnsweredAndTheServerEndsAlthoughItDoesNotRead) {
  StartWithUnreadLog();
  client::Client client = Connect();
  for (int i = 0; i < 1000; ++i) ASSERT_TRUE(client.GetCatalogStatus().ok()) << i;
  server_->Signal(SIGTERM);
  EXPECT_EQ(server_->Wait().exit_status, 0);
}

}  // namespace
}  // namespace graspdb::faults
