// Failures in operation: killed servers, interrupted imports, two servers on one database or port.
#include <gmock/gmock.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "graspdb/v1/upload_service.pb.h"
#include "tests/end_to_end/fixtures/programs_fixture.h"

namespace graspdb::end_to_end {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class FailureTest : public ProgramsTest {
 protected:
  // The views that uploads have sent and not committed.
  std::int64_t SentViews() const {
    std::istringstream lines(Succeed({"uploads", "list", "--json"}).out);
    std::int64_t views = 0;
    for (std::string line; std::getline(lines, line);) {
      v1::Upload upload;
      EXPECT_TRUE(google::protobuf::util::JsonStringToMessage(line, &upload).ok()) << line;
      views += upload.staged_view_count();
    }
    return views;
  }

  // Waits until a running import has sent some views, but not all.
  std::int64_t WaitForViews(std::int64_t at_least) {
    for (;;) {
      const std::int64_t views = SentViews();
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
  EXPECT_GE(SentViews(), seen);
  EXPECT_EQ(Status().view_count(), 0);
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
  EXPECT_EQ(Status().view_count(), 0);
  const std::int64_t revision = Status().catalog_revision();
  const Finished again = Graspdb({"import", Path("set"), "--resume"});
  ASSERT_EQ(again.exit_status, 0) << again.err;
  EXPECT_EQ(Status().view_count(), 72);
  EXPECT_EQ(Status().catalog_revision(), revision + 1);
  const Finished nothing = Graspdb({"import", Path("set"), "--resume"});
  EXPECT_EQ(nothing.exit_status, 1);
  EXPECT_THAT(nothing.err, HasSubstr("leave out --resume"));
}

TEST_F(FailureTest, ABadCaptureIsReportedAndTheOthersAreTaught) {
  StartServer();
  Simulate("set", 60, 1);
  const std::filesystem::path bad = Path("set/clouds/flange_0001.pcd");
  const std::string good = files::BytesOf(bad);
  std::ofstream(bad) << "no cloud";
  const Finished atomic = Graspdb({"import", Path("set"), "--atomic"});
  EXPECT_EQ(atomic.exit_status, 1);
  EXPECT_THAT(atomic.err, HasSubstr("(clouds/flange_0001.pcd: "));
  EXPECT_THAT(atomic.err, HasSubstr("--skip-failed"));
  EXPECT_EQ(Status().view_count(), 0);

  const std::string findings = Graspdb({"doctor"}).out;
  EXPECT_THAT(findings, HasSubstr("has no views yet: they are in uploads/import-"));
  EXPECT_THAT(findings, Not(HasSubstr("delete it")));
  const std::size_t begin = findings.find("import-");
  const std::string upload = findings.substr(begin, findings.find_first_of(" ,;", begin) - begin);
  EXPECT_THAT(Succeed({"uploads", "show", upload, "--json"}).out, HasSubstr("\"failedViews\":[]"));

  const Finished dry = Graspdb({"import", Path("set"), "--dry-run"});
  EXPECT_EQ(dry.exit_status, 1);
  EXPECT_THAT(dry.out, HasSubstr("17 were sent before"));
  EXPECT_EQ(Status().view_count(), 0);

  const Finished most = Graspdb({"import", Path("set")});
  EXPECT_EQ(most.exit_status, 1);
  EXPECT_THAT(most.out, HasSubstr("taught 17 views"));
  EXPECT_THAT(most.err, HasSubstr(bad.filename().string()));
  EXPECT_THAT(most.err, HasSubstr("1 of 18 captures could not be taught"));

  std::ofstream(bad) << good;
  EXPECT_THAT(Succeed({"import", Path("set"), "--atomic"}).out,
              HasSubstr("taught 1 view, 17 were there already"));
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
