// The load test of `graspdb bench` against a server.
#include <gmock/gmock.h>
#include <google/protobuf/struct.pb.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "tests/end_to_end/fixtures/outcome_matchers.h"
#include "tests/end_to_end/fixtures/programs_fixture.h"

namespace graspdb::end_to_end {
namespace {

using ::testing::HasSubstr;
using Words = std::vector<std::string>;
using Fields = google::protobuf::Map<std::string, google::protobuf::Value>;

class BenchTest : public ProgramsTest {
 protected:
  static Words BenchWords(const Words& more) {
    Words words = {"bench", "--simulate", "--parts", "l-bracket,flange", "--json", "--frames", "4"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  // The printed report.
  Fields ReportOf(const Finished& finished) {
    const auto status = google::protobuf::util::JsonStringToMessage(finished.out, &report_);
    EXPECT_TRUE(status.ok()) << finished.out << finished.err;
    return report_.fields();
  }

  static double Number(const Fields& fields, const std::string& key) {
    return fields.count(key) == 0 ? -1 : fields.at(key).number_value();
  }

  // Waits until the server's log has this many calls.
  void WaitForCalls(int count) const {
    for (;;) {
      const std::string log = server_->Errors();
      int calls = 0;
      for (std::size_t at = log.find("method=Recognize"); at != std::string::npos;
           at = log.find("method=Recognize", at + 1)) {
        ++calls;
      }
      if (calls >= count) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }

  google::protobuf::Struct report_;
};

TEST_F(BenchTest, ClosedLoopSendsTheGivenNumberOfRequests) {
  StartServer();
  Simulate("set", 60, 1);
  Succeed({"import", Path("set"), "--split", "TEACH"});
  const Fields report = ReportOf(Succeed(BenchWords({"--requests", "25", "--concurrency", "3"})));
  EXPECT_EQ(Number(report, "answered"), 25);
  EXPECT_EQ(Number(report, "failed"), 0);
  double outcomes = 0;
  for (const auto& [status, count] : report.at("outcomes").struct_value().fields()) {
    outcomes += count.number_value();
  }
  EXPECT_EQ(outcomes, 25);
  EXPECT_GE(Number(report.at("outcomes").struct_value().fields(), "OK"), 20);
  EXPECT_EQ(Number(report.at("latency").struct_value().fields(), "count"), 25);
  EXPECT_THAT(report.at("plan").struct_value().fields().at("frames").string_value(),
              HasSubstr("4 depth images of 512 x 424"));
  double named = 0;
  for (const auto& step : report.at("steps").list_value().values()) {
    const Fields& fields = step.struct_value().fields();
    if (fields.at("in_server").bool_value()) named += Number(fields, "share");
  }
  EXPECT_GT(named, 0);
  EXPECT_LT(named, 1);
}

TEST_F(BenchTest, OpenLoopReportsItsSchedule) {
  StartServer();
  const Finished done =
      Succeed(BenchWords({"--requests", "10", "--rate", "20", "--concurrency", "2"}));
  const Fields report = ReportOf(done);
  EXPECT_EQ(Number(report, "answered"), 10);
  EXPECT_EQ(report.at("plan").struct_value().fields().at("loop").string_value(), "open");
  EXPECT_GE(Number(report, "elapsed_s"), 9.0 / 20);  // when the last one was due
  EXPECT_GE(Number(report.at("schedule").struct_value().fields(), "latest_ms"), 0);
}

TEST_F(BenchTest, PrintsAReadableReport) {
  StartServer();
  Words words = BenchWords({"--requests", "5"});
  std::erase(words, "--json");
  const Finished done = Succeed(words);
  EXPECT_THAT(done.out, HasSubstr("5 requests in"));
  EXPECT_THAT(done.out, HasSubstr("network and queue"));
}

TEST_F(BenchTest, SendsScansOfASetWithTheirCell) {
  StartServer();
  Simulate("set", 90, 3);
  const Words bench = {"bench", Path("set"), "--split", "QUERY", "--json", "--requests", "6"};
  EXPECT_EQ(Number(ReportOf(Succeed(bench)), "answered"), 6);
  Words with_cell = bench;
  with_cell.insert(with_cell.end(), {"--cell", "nowhere"});
  const Finished refused = Graspdb(with_cell);
  EXPECT_THAT(refused, EndsWith(1));
  EXPECT_THAT(refused.err, HasSubstr("no request was answered: there is no cell cells/nowhere"));
  const Fields report = ReportOf(refused);
  EXPECT_EQ(Number(report, "failed"), 6);
  const auto& error = report.at("errors").list_value().values(0).struct_value().fields();
  EXPECT_EQ(error.at("code").string_value(), "NOT_FOUND");
}

TEST_F(BenchTest, CountsErrorsAndEndsWithoutTheServer) {
  StartServer();
  const auto bench =
      StartGraspdb(BenchWords({"--rate", "100", "--requests", "300", "--concurrency", "4"}));
  WaitForCalls(20);
  server_->Signal(SIGKILL);
  const Finished done = bench->Wait();
  EXPECT_THAT(done, EndsWith(0));
  const Fields report = ReportOf(done);
  EXPECT_GE(Number(report, "answered"), 1);
  EXPECT_EQ(Number(report, "answered") + Number(report, "failed"), 300);
  const auto& errors = report.at("errors").list_value();
  ASSERT_EQ(errors.values_size(), 1);
  const Fields& error = errors.values(0).struct_value().fields();
  EXPECT_EQ(error.at("code").string_value(), "UNAVAILABLE");
  EXPECT_THAT(error.at("example").string_value(), HasSubstr("start graspdb-server"));
}

TEST_F(BenchTest, ControlCEndsARunWithAReport) {
  StartServer();
  const auto bench = StartGraspdb(BenchWords({"--duration", "100000"}));
  WaitForCalls(12);
  bench->Signal(SIGINT);
  const Finished done = bench->Wait();
  EXPECT_THAT(done, EndsWith(0));
  const Fields report = ReportOf(done);
  EXPECT_TRUE(report.at("interrupted").bool_value());
  EXPECT_GE(Number(report, "answered"), 1);
}

TEST_F(BenchTest, CountsExceededDeadlines) {
  StartServer();
  const Fields report =
      ReportOf(Graspdb(BenchWords({"--requests", "20", "--timeout", "0.001", "--camera", "v1"})));
  EXPECT_EQ(Number(report, "answered") + Number(report, "failed"), 20);
  // Others may find the queue full of requests that the server has not yet given up.
  std::vector<std::string> codes;
  for (const auto& error : report.at("errors").list_value().values()) {
    codes.push_back(error.struct_value().fields().at("code").string_value());
  }
  EXPECT_THAT(codes, ::testing::Contains("DEADLINE_EXCEEDED"));
}

}  // namespace
}  // namespace graspdb::end_to_end
