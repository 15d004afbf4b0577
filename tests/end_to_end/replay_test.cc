// Replay of kept requests by the command line.
#include <gmock/gmock.h>

#include "client/cell/blackbox/black_box.h"
#include "client/cli/recognize/scan_source.h"
#include "client/sdk/client.h"
#include "tests/end_to_end/fixtures/outcome_matchers.h"
#include "tests/end_to_end/fixtures/programs_fixture.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::end_to_end {
namespace {

using graspdb::testing::IsOk;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class ReplayTest : public ProgramsTest {
 protected:
  void SetUp() override {
    StartServer();
    Simulate("set", 60, 3);
    Succeed({"import", Path("set")});
    KeepAll();
  }

  // Recognizes the scenes like a cell, with timings, and keeps the requests.
  void KeepAll() {
    client::Client client({.server = address_});
    auto box = client::BlackBox::Open({.ring = {.folder = Path("bundles"), .min_free_bytes = 0}});
    ASSERT_THAT(box, IsOk());
    const auto scans = client::ListScans({Path("set")}, "QUERY");
    ASSERT_THAT(scans, IsOk());
    for (const client::ScanTask& scan : scans->tasks) {
      v1::Bundle bundle;
      *bundle.mutable_request() = *client::ReadScan(scan);
      const auto response = client.Recognize(bundle.request());
      ASSERT_THAT(response, IsOk());
      EXPECT_GT(response->timings().total_ms(), 0);
      *bundle.mutable_response() = *response;
      EXPECT_TRUE((*box)->Keep(std::move(bundle)));
    }
  }

  Finished Replay(std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"replay", Path("bundles")});
    return Graspdb(more);
  }
};

TEST_F(ReplayTest, GivesTheSameAnswersAlsoAfterARestart) {
  EXPECT_THAT(Succeed({"replay", Path("bundles")}).out, HasSubstr("3 same, 0 different"));
  server_.reset();
  StartServer();
  EXPECT_THAT(Succeed({"replay", Path("bundles")}).out,
              AllOf(HasSubstr("3 same, 0 different"), Not(HasSubstr("revision"))));
}

TEST_F(ReplayTest, IgnoresAnotherRevisionWithTheSameAnswers) {
  Succeed({"objects", "set", "flange", "--display-name", "Flange 3"});
  EXPECT_THAT(Succeed({"replay", Path("bundles")}).out,
              AllOf(HasSubstr("3 same"), HasSubstr("(revision ")));
}

TEST_F(ReplayTest, ReportsDifferencesWithExitStatus1) {
  for (const char* object : {"flange", "handle", "l-bracket"}) {
    Succeed({"objects", "delete", object, "--force"});
  }
  const Finished text = Replay();
  EXPECT_THAT(text, EndsWith(1));
  EXPECT_THAT(text, PrintsOnly("graspdb", "0 same, 3 different"));
  EXPECT_THAT(text.out, AllOf(HasSubstr("different   "), HasSubstr("(revision "),
                              HasSubstr(", now something unknown")));
  const Finished json = Replay({"--json"});
  EXPECT_THAT(json, EndsWith(1));
  EXPECT_EQ(CountLines(json.out), 3);
  EXPECT_THAT(json.out, AllOf(HasSubstr("\"same\":false"), HasSubstr("\"differences\":[")));
}

TEST_F(ReplayTest, ReportsUnreadableBundlesAndReplaysTheOthers) {
  folder_.Write("bundles/0000000000-x.bundle", "no bundle");
  const Finished done = Replay();
  EXPECT_THAT(done, EndsWith(1));
  EXPECT_THAT(done, PrintsOnly("graspdb", "3 same, 0 different, 1 unreadable of 4"));
  EXPECT_THAT(done.out, HasSubstr("unreadable"));
}

TEST_F(ReplayTest, ReportsNoDifferencesWithoutAServer) {
  server_.reset();
  const Finished done = Replay({"--timeout", "2"});
  EXPECT_THAT(done, EndsWith(3));
  EXPECT_THAT(done.out, Not(HasSubstr("different")));
}

}  // namespace
}  // namespace graspdb::end_to_end
