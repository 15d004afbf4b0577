// graspdb-server as a process: start, stop, and rejected settings.
#include <gmock/gmock.h>

#include <csignal>

#include "tests/end_to_end/fixtures/outcome_matchers.h"
#include "tests/end_to_end/fixtures/programs_fixture.h"

namespace graspdb::end_to_end {
namespace {

using ::testing::HasSubstr;
using ::testing::MatchesRegex;

constexpr char kServer[] = "graspdb-server";

class ServerProcessTest : public ProgramsTest {
 protected:
  Finished Serve(const std::vector<std::string>& flags) const {
    std::vector<std::string> command = {GRASPDB_SERVER_PROGRAM};
    command.insert(command.end(), flags.begin(), flags.end());
    return RunProgram(folder_.path(), command);
  }
};

TEST_F(ServerProcessTest, AnIndexOfEarlierSettingsIsReported) {
  StartServer("db", {"--index", "flann"});
  EXPECT_TRUE(server_->WaitForError("event=option_without_effect option=--index"));
}

TEST_F(ServerProcessTest, LogsItsAddressAndExitsWithZeroOnSigterm) {
  for (const int signal : {SIGTERM, SIGINT}) {
    StartServer();
    EXPECT_EQ(Status().view_count(), 0);
    server_->Signal(signal);
    const Finished outcome = server_->Wait();
    EXPECT_THAT(outcome, EndsWith(0));
    EXPECT_THAT(outcome.out, MatchesRegex("listening on 127\\.0\\.0\\.1:[0-9]+\n"));
    EXPECT_THAT(outcome.err, HasSubstr("event=stop"));
  }
}

TEST_F(ServerProcessTest, AStartThatDescribesViewsAgainEndsOnSigterm) {
  StartServer();
  Simulate("set", 120, 1);
  Succeed({"import", Path("set")});
  server_->Signal(SIGTERM);
  server_->Wait();
  // The signal waits for the server from its first instruction on.
  const std::string script =
      "import os, signal, sys\n"
      "signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGTERM})\n"
      "os.kill(os.getpid(), signal.SIGTERM)\n"
      "os.execv(sys.argv[1], sys.argv[1:])\n";
  std::vector<std::string> command = ServerCommand(Path("db"), "127.0.0.1:0");
  command.insert(command.end(), {"--voxel-size", "0.005"});
  command.insert(command.begin(), {"/usr/bin/python3", "-c", script});
  const Finished stopped = RunProgram(folder_.path(), command);
  EXPECT_THAT(stopped, EndsWith(0));
  EXPECT_EQ(stopped.out, "") << "it does not listen";
  EXPECT_THAT(stopped.err, HasSubstr("event=start_cancelled signal=15"));
  StartServer("db", {"--voxel-size", "0.005"});
  EXPECT_EQ(Status().left_out_record_count(), 0);
}

TEST_F(ServerProcessTest, AnswersItsOwnHealthCheck) {
  StartServer();
  const Finished serving = Serve({"health", address_});
  EXPECT_THAT(serving, EndsWith(0));
  EXPECT_EQ(serving.out, "SERVING\n");
  server_->Signal(SIGKILL);
  server_->Wait();
  const Finished down = Serve({"health", address_, "--timeout", "0.5"});
  EXPECT_THAT(down, EndsWith(1));
  EXPECT_THAT(down, PrintsOnly(kServer, address_));
  EXPECT_THAT(Serve({"health", address_, "--cert", "server.pem"}), EndsWith(2));
}

TEST_F(ServerProcessTest, ReportsErrorsInOneSentence) {
  StartServer();
  EXPECT_THAT(Serve({"--db", Path("db"), "--listen", "127.0.0.1:0"}),
              PrintsOnly(kServer, "in use by another process"));
  EXPECT_THAT(Serve({"--db", Path("other"), "--listen", address_}),
              PrintsOnly(kServer, "cannot listen on " + address_));
}

TEST_F(ServerProcessTest, ListensOnLocalhostByDefault) {
  const Finished outcome = Serve({"--db", Path("db"), "--listen", "0.0.0.0:0"});
  EXPECT_THAT(outcome, EndsWith(1));
  EXPECT_THAT(outcome, PrintsOnly(kServer, "--allow-remote-without-tls"));
  EXPECT_THAT(Serve({"--db", Path("db"), "--listen", "here"}), EndsWith(2));
}

TEST_F(ServerProcessTest, DoesNotUseAFolderWithOtherFiles) {
  folder_.Write("diary.txt", "Dear diary");
  const Finished outcome = Serve({"--db", folder_.path().string(), "--listen", "127.0.0.1:0"});
  EXPECT_THAT(outcome, EndsWith(1));
  EXPECT_THAT(outcome, PrintsOnly(kServer, folder_.path().string()));
}

TEST_F(ServerProcessTest, ExitsWithTwoForWrongUsage) {
  EXPECT_THAT(Serve({}), EndsWith(2));
  EXPECT_THAT(Serve({"--db", Path("db"), "--queue", "-3"}), EndsWith(2));
  EXPECT_THAT(Serve({"--db", Path("db"), "--colour", "red"}), EndsWith(2));
}

TEST_F(ServerProcessTest, EscapesClientTextInTheLog) {
  StartServer();
  EXPECT_THAT(Graspdb({"objects", "show", "x\nlevel=error forged=\"1\""}), EndsWith(1));
  server_->Signal(SIGTERM);
  const Finished outcome = server_->Wait();
  EXPECT_THAT(outcome.err, HasSubstr("forged"));
  EXPECT_THAT(outcome.err, ::testing::Not(HasSubstr("\nlevel=error")));
}

}  // namespace
}  // namespace graspdb::end_to_end
