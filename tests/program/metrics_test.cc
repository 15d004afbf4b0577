#include <gmock/gmock.h>

#include "program/metrics/families.h"
#include "program/metrics/metrics_server.h"

namespace graspdb {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::SizeIs;
using ::testing::StartsWith;

TEST(EventFamily, HasASeriesForEachCombinationOfLabels) {
  CounterFamily picks("picks", "Picks.", {"cell", "outcome"});
  picks.With({"a", "missed"}).Increment();
  picks.With({"a", "picked"}).Increment();
  picks.With({"a", "picked"}).Increment();
  const prometheus::MetricFamily all = picks.Collect();
  ASSERT_THAT(all.metric, SizeIs(2));
  EXPECT_EQ(all.metric[1].counter.value, 2);
  EXPECT_EQ(all.metric[1].label[1].name, "outcome");
  EXPECT_EQ(all.metric[1].label[1].value, "picked");
}

TEST(EventFamily, BeyondTheLimitSeriesAreCountedTogether) {
  CounterFamily picks("picks", "Picks.", {"cell"});
  for (std::size_t i = 0; i < CounterFamily::kMaxSeries + 50; ++i) {
    picks.With({std::to_string(i)}).Increment();
  }
  picks.With({"0"}).Increment();
  EXPECT_THAT(picks.Collect().metric, SizeIs(CounterFamily::kMaxSeries + 1));
  EXPECT_EQ(picks.With({"other"}).Value(), 50);
  EXPECT_EQ(picks.With({"0"}).Value(), 2);
}

TEST(MetricsServer, APortInUseIsAnErrorWithAdvice) {
  const auto collect = [] { return MetricFamilies(); };
  const auto first = MetricsServer::Start({.listen = "127.0.0.1:0"}, collect);
  ASSERT_TRUE(first.ok()) << first.status();
  const std::string address = (*first)->address();
  const absl::Status second = MetricsServer::Start({.listen = address}, collect).status();
  EXPECT_EQ(second.code(), absl::StatusCode::kUnavailable);
  EXPECT_THAT(std::string(second.message()),
              AllOf(StartsWith("cannot listen on " + address + " for metrics; "),
                    EndsWith("Choose another --metrics-listen")));
}

}  // namespace
}  // namespace graspdb
