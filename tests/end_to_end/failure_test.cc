// Failures in operation: killed servers, interrupted imports, two servers on one database or port.
#include <gmock/gmock.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "tests/end_to_end/programs_fixture.h"

namespace graspdb::end_to_end {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class FailureTest : public ProgramsTest {
 protected:
  // Waits until a running import has taught some views, but not all.
  std::int64_t WaitForViews(std::int64_t at_least) {
    for (;;) {
      const std::int64_t views = Status().view_count();
      if (views >= at_least || HasFailure()) return views;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }
};

TEST_F(FailureTest, ServerKilledDuringAnImportLosesNothingAcknowledged) {
  StartServer();
  Simulate("set", 15, 6);
  const auto import = StartGraspdb({"import", Path("set")});
  const std::int64_t seen = WaitForViews(10);
  server_->Signal(SIGKILL);
  EXPECT_EQ(server_->Wait().exit_status, 128 + SIGKILL);
  const Finished broken = import->Wait();
  EXPECT_EQ(broken.exit_status, 3) << broken.out;
  EXPECT_THAT(broken.err, HasSubstr("start graspdb-server"));

  StartServer();
  EXPECT_GE(Status().view_count(), seen);
  const Finished again = Graspdb({"import", Path("set")});
  ASSERT_EQ(again.exit_status, 0) << again.err;
  EXPECT_EQ(Status().view_count(), 72);
  EXPECT_EQ(CountRight(Recognize("set")), 6);
}

TEST_F(FailureTest, ResumesAnInterruptedImport) {
  StartServer();
  Simulate("set", 15, 1);
  const auto import = StartGraspdb({"import", Path("set")});
  WaitForViews(1);
  import->Signal(SIGINT);
  const Finished broken = import->Wait();
  EXPECT_EQ(broken.exit_status, 1);
  EXPECT_THAT(broken.err, HasSubstr("run the same command again"));
  ASSERT_EQ(Graspdb({"import", Path("set")}).exit_status, 0);
  EXPECT_EQ(Status().view_count(), 72);
}

TEST_F(FailureTest, RejectsASecondServerOnADatabase) {
  StartServer();
  const Finished second = RunProgram(folder_.path(), ServerCommand(Path("db"), "127.0.0.1:0"));
  EXPECT_EQ(second.exit_status, 1);
  EXPECT_THAT(second.err, HasSubstr("in use"));
  EXPECT_THAT(second.out, Not(HasSubstr("listening")));
  EXPECT_EQ(Graspdb({"status"}).exit_status, 0);
}

TEST_F(FailureTest, RejectsASecondServerOnAPort) {
  StartServer();
  const Finished second = RunProgram(folder_.path(), ServerCommand(Path("other"), address_));
  EXPECT_EQ(second.exit_status, 1);
  EXPECT_THAT(second.err, HasSubstr("cannot listen on"));
}

TEST_F(FailureTest, TermSignalEndsTheServerInOrder) {
  StartServer();
  server_->Signal(SIGTERM);
  const Finished stopped = server_->Wait();
  EXPECT_EQ(stopped.exit_status, 0);
  EXPECT_THAT(stopped.err, HasSubstr("event=stop"));
  EXPECT_EQ(Graspdb({"status"}).exit_status, 3);
}

}  // namespace
}  // namespace graspdb::end_to_end
