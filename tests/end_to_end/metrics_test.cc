// Metrics of the programs over HTTP, and request ids in logs and bundles.
#include <gmock/gmock.h>

#include <csignal>
#include <filesystem>
#include <regex>

#include "absl/strings/str_cat.h"
#include "client/cell/blackbox/bundle_files.h"
#include "tests/end_to_end/fixtures/cell_fixture.h"
#include "tests/end_to_end/fixtures/outcome_matchers.h"
#include "tests/testing/scrape.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::end_to_end {
namespace {

using client::GriCode;
using ::testing::HasSubstr;
using testing::HttpGet;
using testing::IsOk;
using testing::ValueOf;

class ProgramMetricsTest : public CellProgramsTest {
 protected:
  // Without the path of "http://HOST:PORT/metrics".
  static std::string Address(const std::string& url) {
    return std::regex_replace(url, std::regex("http://|/metrics"), "");
  }

  // A server with metrics on the database of StartCell.
  void RestartWithMetrics() {
    server_->Signal(SIGTERM);
    server_->Wait();
    StartServer("db", {"--metrics-listen", "127.0.0.1:0"});
    server_metrics_ = Address(server_->WaitForLine("metrics on "));
    ASSERT_NE(server_metrics_, "");
  }

  std::string server_metrics_;
};

TEST_F(ProgramMetricsTest, CountAJobInServerAndAgent) {
  StartCell();
  RestartWithMetrics();
  LayOut(1);
  StartAgent({"--metrics-listen", "127.0.0.1:0"});
  const std::string agent_metrics = agent_->WaitForLine("metrics on ");
  AwaitCode(GriCode::kNoError);

  const std::string server = HttpGet(server_metrics_, "/metrics");
  EXPECT_THAT(HttpGet(server_metrics_, "/metricsx"), HasSubstr("404"));
  EXPECT_THAT(server, HasSubstr("HTTP/1.1 200"));
  EXPECT_GE(ValueOf(server, "graspdb_frames_total{cell=\"cells/press-3\",status=\"OK\"}"), 1);
  EXPECT_GE(ValueOf(server, "graspdb_detection_score_count"), 1);
  EXPECT_EQ(ValueOf(server, "graspdb_serving"), 1);

  const std::string agent = HttpGet(agent_metrics, "/metrics");
  EXPECT_GE(ValueOf(agent, "graspdb_cell_jobs_total{cell=\"cells/press-3\",job=\"1\",code=\"OK\"}"),
            1);
  EXPECT_EQ(ValueOf(agent, "graspdb_cell_camera_ready{cell=\"cells/press-3\"}"), 1);
  EXPECT_EQ(ValueOf(agent, "graspdb_cell_server_ready{cell=\"cells/press-3\"}"), 1);
  EXPECT_GE(ValueOf(agent, "graspdb_cell_frame_age_seconds{cell=\"cells/press-3\"}"), 0);
  client::GriClient robot = Robot();
  Trigger(robot);
  EXPECT_GE(ValueOf(HttpGet(agent_metrics, "/metrics"),
                    "graspdb_cell_robot_connections{cell=\"cells/press-3\",protocol=\"gri\"}"),
            1);
  const auto documented =
      testing::MetricsInDocument(GRASPDB_SOURCE_DIR "/docs/metrics.md", "Agent");
  const auto served = testing::MetricsIn(agent);
  for (const auto& [name, text] : served) {
    const auto row = documented.find(name);
    EXPECT_TRUE(row != documented.end() && row->second == text)
        << "docs/metrics.md needs: | `" << name << "` | " << text.type << " | | " << text.help
        << " |";
  }
  EXPECT_EQ(served.size(), documented.size());
}

TEST_F(ProgramMetricsTest, ARequestIdIsInBothLogsAndInTheBundle) {
  StartCell();
  LayOut(1);
  StartAgent({"--black-box", Path("bundles"), "--black-box-all"});
  AwaitCode(GriCode::kNoError);
  agent_->Signal(SIGTERM);
  const std::string agent_log = agent_->Wait().err;
  std::vector<std::filesystem::path> bundles(std::filesystem::directory_iterator(Path("bundles")),
                                             {});
  std::erase_if(bundles, [](const auto& path) { return path.extension() != ".bundle"; });
  ASSERT_FALSE(bundles.empty());
  const auto bundle = client::ReadBundle(*std::ranges::max_element(bundles));
  ASSERT_THAT(bundle, IsOk());
  ASSERT_NE(bundle->request_id(), "");
  const std::string field = absl::StrCat(" request_id=", bundle->request_id());
  EXPECT_THAT(agent_log, HasSubstr(field));
  EXPECT_TRUE(server_->WaitForError(field + " cell=cells/press-3 status=OK"));
}

TEST_F(ProgramMetricsTest, TheCommandLinePrintsTheRequestIdOfAnErrorIfVerbose) {
  StartServer();
  EXPECT_THAT(Graspdb({"objects", "show", "none"}), PrintsOnly("graspdb", "none"));
  const Finished verbose = Graspdb({"--verbose", "objects", "show", "none"});
  std::smatch id;
  ASSERT_TRUE(std::regex_search(verbose.err, id, std::regex("graspdb: request id ([0-9a-f]+)\n")))
      << verbose.err;
  EXPECT_TRUE(server_->WaitForError("request_id=" + id[1].str()));
}

TEST_F(ProgramMetricsTest, NoPortIsOpenByDefaultAndOtherAddressesNeedAFlag) {
  StartServer();
  server_->Signal(SIGTERM);
  EXPECT_THAT(server_->Wait().out, ::testing::Not(HasSubstr("metrics")));
  const Finished remote =
      RunProgram(folder_.path(), {GRASPDB_SERVER_PROGRAM, "--db", Path("db"), "--listen",
                                  "127.0.0.1:0", "--metrics-listen", "0.0.0.0:0"});
  EXPECT_THAT(remote, EndsWith(1));
  EXPECT_THAT(remote, PrintsOnly("graspdb-server", "--allow-remote-metrics"));
}

}  // namespace
}  // namespace graspdb::end_to_end
