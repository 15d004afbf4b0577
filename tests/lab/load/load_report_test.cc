// Reports of a load test.
#include "lab/load/load_report.h"

#include <gmock/gmock.h>
#include <google/protobuf/struct.pb.h>
#include <google/protobuf/util/json_util.h>

namespace graspdb::lab {
namespace {

using std::chrono::milliseconds;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

// A hundred answers after 1 to 100 ms, of which 3 tenths were the server's, and one error.
LoadReport Report(double rate) {
  LoadReport out;
  out.server = "127.0.0.1:5";
  out.catalog.set_server_version("9.8");
  out.catalog.set_view_count(192);
  out.frames = "3 clouds";
  out.plan = {.concurrency = 2, .rate = rate, .requests = 101};
  const RequestTimes::Time start;
  for (int i = 1; i <= 100; ++i) {
    v1::RecognizeResponse response;
    response.set_status(i <= 90 ? v1::OK : v1::UNKNOWN_OBJECT);
    response.mutable_timings()->set_total_ms(0.3 * i);
    response.add_stages()->set_stage("match");
    response.mutable_stages(0)->set_duration_ms(0.1 * i);
    out.result.tally.AddAnswer({start, start, start + milliseconds(i)}, response);
  }
  out.result.tally.AddError({start, start + milliseconds(6), start + milliseconds(50)},
                            absl::DeadlineExceededError("too late"));
  out.result.elapsed = std::chrono::seconds(4);
  return out;
}

google::protobuf::Struct Json(const LoadReport& report) {
  google::protobuf::Struct out;
  const auto text = LoadJson(report);
  EXPECT_TRUE(text.ok()) << text.status();
  EXPECT_EQ(text->find('\n'), std::string::npos);
  EXPECT_TRUE(google::protobuf::util::JsonStringToMessage(*text, &out).ok());
  return out;
}

TEST(LoadText, HasCountsLatenciesAndSteps) {
  const std::string text = LoadText(Report(0));
  EXPECT_THAT(text, AllOf(HasSubstr("graspdb 9.8 at 127.0.0.1:5, 0 objects, 192 views"),
                          HasSubstr("101 requests in 4.00 s: 100 answered (25.00/s), 1 failed"),
                          HasSubstr("3 clouds"), HasSubstr("2 in flight")));
  EXPECT_THAT(text, ::testing::ContainsRegex("OK +90\n"));
  EXPECT_THAT(text,
              ::testing::ContainsRegex("DEADLINE_EXCEEDED +1 +up to 50.0 ms, e.g.: too late"));
  EXPECT_THAT(text, ::testing::ContainsRegex("1.000 +50.500 +50.0[0-9]+ +90.0[0-9]+ +99.0"));
  EXPECT_THAT(text, ::testing::ContainsRegex("server in total +15.150 .* 30.0 %"));
  EXPECT_THAT(text, ::testing::ContainsRegex("network and queue +35.350 .* 70.0 %"));
  EXPECT_THAT(text, ::testing::ContainsRegex("  match +5.050 .* 10.0 %"));
  EXPECT_THAT(text, Not(HasSubstr("before sending")));
}

TEST(LoadText, WarnsAboutARateThatWasNotKept) {
  LoadReport report = Report(50);
  EXPECT_THAT(LoadText(report),
              AllOf(HasSubstr("50 requests/s, evenly spaced, at most 2 in flight"),
                    HasSubstr("sent more than 1 ms late: 1, the latest by 6.0 ms"),
                    HasSubstr("before sending"), Not(HasSubstr("NOT KEPT"))));
  report.result.backlog = 40;
  EXPECT_THAT(LoadText(report), AllOf(HasSubstr("due and not sent at the end: 40"),
                                      HasSubstr("THE RATE OF 50/s WAS NOT KEPT")));
}

TEST(LoadText, ReportsModelCacheMisses) {
  LoadReport report = Report(0);
  EXPECT_THAT(LoadText(report), Not(HasSubstr("models in memory")));
  report.models.set_hit_count(3);
  report.models.set_miss_count(1);
  report.models.set_byte_budget(1 << 20);
  EXPECT_THAT(LoadText(report), AllOf(HasSubstr("models in memory         75.0 % of 4 found"),
                                      Not(HasSubstr("--memory-mib"))));
  report.models.set_byte_count(1 << 20);
  EXPECT_THAT(LoadText(report), HasSubstr("--memory-mib"));
}

TEST(LoadText, HasNoLatencyWithoutAnAnswer) {
  LoadReport report;
  report.result.tally.AddError({}, absl::UnavailableError("gone"));
  EXPECT_THAT(LoadText(report),
              AllOf(HasSubstr("0 answered"), HasSubstr("UNAVAILABLE"), Not(HasSubstr("latency"))));
}

TEST(LoadJson, HasEverything) {
  const google::protobuf::Struct json = Json(Report(50));
  const auto& fields = json.fields();
  EXPECT_EQ(fields.at("answered").number_value(), 100);
  EXPECT_EQ(fields.at("failed").number_value(), 1);
  EXPECT_EQ(fields.at("answered_per_s").number_value(), 25);
  EXPECT_EQ(fields.at("outcomes").struct_value().fields().at("UNKNOWN_OBJECT").number_value(), 10);
  const auto& error = fields.at("errors").list_value().values(0).struct_value().fields();
  EXPECT_EQ(error.at("code").string_value(), "DEADLINE_EXCEEDED");
  EXPECT_EQ(error.at("example").string_value(), "too late");
  const auto& latency = fields.at("latency").struct_value().fields();
  EXPECT_EQ(latency.at("mean_ms").number_value(), 50.5);
  const auto& ladder = latency.at("percentiles").list_value();
  ASSERT_EQ(ladder.values_size(), static_cast<int>(kPercentiles.size()));
  const auto& median = ladder.values(2).struct_value().fields();
  EXPECT_EQ(median.at("percent").number_value(), 50);
  EXPECT_NEAR(median.at("ms").number_value(), 50, 0.05);
  EXPECT_TRUE(fields.at("schedule").struct_value().fields().at("rate_kept").bool_value());
  EXPECT_EQ(fields.at("plan").struct_value().fields().at("loop").string_value(), "open");
  const auto& server = fields.at("steps").list_value().values(2).struct_value().fields();
  EXPECT_EQ(server.at("step").string_value(), "server in total");
  EXPECT_NEAR(server.at("share").number_value(), 0.3, 1e-6);
}

TEST(LoadJson, HasNoScheduleForAClosedLoop) {
  const google::protobuf::Struct json = Json(Report(0));
  EXPECT_EQ(json.fields().count("schedule"), 0U);
  const auto& first = json.fields().at("steps").list_value().values(0).struct_value().fields();
  EXPECT_EQ(first.at("step").string_value(), "network and queue");
  EXPECT_EQ(json.fields().at("plan").struct_value().fields().at("loop").string_value(), "closed");
}

TEST(LatencyBins, CountEveryTimeOnceAndOutliersInTheLast) {
  LatencyHistogram histogram;
  for (int i = 0; i < 990; ++i) histogram.Record(milliseconds(10 + i % 10));
  for (int i = 0; i < 5; ++i) histogram.Record(milliseconds(5000));
  const std::vector<LatencyBin> bins = BinsOf(histogram);
  ASSERT_EQ(bins.size(), 11U);
  EXPECT_EQ(bins.front().from, milliseconds(10));
  EXPECT_EQ(bins.back().to, milliseconds(5000));
  EXPECT_LT(bins.back().count, 110);
  std::int64_t count = 0;
  for (std::size_t i = 0; i < bins.size(); ++i) {
    count += bins[i].count;
    EXPECT_EQ(bins[i].to, i + 1 < bins.size() ? bins[i + 1].from : histogram.Max());
  }
  EXPECT_EQ(count, histogram.count());
}

TEST(LatencyBins, HaveOneBinForEqualTimes) {
  LatencyHistogram histogram;
  EXPECT_TRUE(BinsOf(histogram).empty());
  for (int i = 0; i < 7; ++i) histogram.Record(milliseconds(3));
  const std::vector<LatencyBin> bins = BinsOf(histogram);
  ASSERT_EQ(bins.size(), 1U);
  EXPECT_EQ(bins[0].count, 7);
}

}  // namespace
}  // namespace graspdb::lab
