// Counts of answers and errors in a load test.
#include <gmock/gmock.h>

#include "lab/load/load_run.h"

namespace graspdb::lab {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using ::testing::ElementsAre;
using ::testing::Pair;

// Due at 0, sent and finished the given milliseconds later.
RequestTimes Times(int sent_ms, int finished_ms) {
  const RequestTimes::Time start;
  return {start, start + milliseconds(sent_ms), start + milliseconds(finished_ms)};
}

v1::RecognizeResponse Response(v1::RecognitionStatus status) {
  v1::RecognizeResponse out;
  out.set_status(status);
  out.mutable_timings()->set_total_ms(10);
  out.mutable_timings()->set_decode_ms(1);
  const auto add = [&](const char* name, double ms) {
    out.add_stages()->set_stage(name);
    out.mutable_stages(out.stages_size() - 1)->set_duration_ms(ms);
  };
  add("region", 2);
  if (status == v1::OK) add("match", 4.5);
  return out;
}

std::vector<std::pair<std::string, nanoseconds>> SumsOf(const Tally& tally) {
  std::vector<std::pair<std::string, nanoseconds>> out;
  for (const Step& step : tally.steps()) out.emplace_back(step.name, step.times.Sum());
  return out;
}

TEST(Tally, LatencyCountsFromTheDueTime) {
  Tally tally;
  tally.AddAnswer(Times(5, 20), Response(v1::OK));
  EXPECT_EQ(tally.latency().Max(), milliseconds(20));
  EXPECT_EQ(tally.lateness().Max(), milliseconds(5));
}

TEST(Tally, StepsAddUpToTheLatency) {
  Tally tally;
  tally.AddAnswer(Times(5, 20), Response(v1::OK));
  EXPECT_THAT(SumsOf(tally),
              ElementsAre(Pair("before sending", milliseconds(5)),
                          Pair("network and queue", milliseconds(5)),
                          Pair("server in total", milliseconds(10)),
                          Pair("decode", milliseconds(1)), Pair("region", milliseconds(2)),
                          Pair("match", microseconds(4500)), Pair("rest", microseconds(2500))));
  for (const Step& step : tally.steps()) {
    const bool outside = step.name == "before sending" || step.name == "network and queue" ||
                         step.name == "server in total";
    EXPECT_EQ(step.in_server, !outside) << step.name;
  }
}

TEST(Tally, CountsOutcomesAndErrorsByName) {
  Tally tally;
  tally.AddAnswer(Times(0, 1), Response(v1::OK));
  tally.AddAnswer(Times(0, 1), Response(v1::UNKNOWN_OBJECT));
  tally.AddAnswer(Times(0, 1), Response(v1::OK));
  tally.AddError(Times(0, 7), absl::UnavailableError("gone"));
  tally.AddError(Times(0, 3), absl::UnavailableError("still gone"));
  tally.AddError(Times(0, 30), absl::DeadlineExceededError("late"));
  EXPECT_EQ(tally.answered(), 3);
  EXPECT_EQ(tally.failed(), 3);
  EXPECT_THAT(tally.outcomes(), ElementsAre(Pair("OK", 2), Pair("UNKNOWN_OBJECT", 1)));
  ASSERT_EQ(tally.errors().size(), 2U);
  const FailedRequests& gone = tally.errors().at(absl::StatusCode::kUnavailable);
  EXPECT_EQ(gone.count, 2);
  EXPECT_EQ(gone.example, "gone");
  EXPECT_EQ(gone.longest, milliseconds(7));
  EXPECT_EQ(tally.latency().Max(), milliseconds(1));  // an error is no answer
}

TEST(Tally, MergedTalliesEqualOneTally) {
  Tally whole;
  Tally mine;
  Tally other;
  for (int i = 0; i < 20; ++i) {
    const RequestTimes times = Times(i, 20 + 2 * i);
    Tally& part = i % 3 == 0 ? mine : other;
    for (Tally* tally : {&whole, &part}) {
      if (i % 5 == 4) {
        tally->AddError(times, absl::InternalError("broken"));
      } else {
        tally->AddAnswer(times, Response(i % 2 == 0 ? v1::OK : v1::NO_CLUSTER));
      }
    }
  }
  mine.Merge(other);
  EXPECT_EQ(mine.answered(), whole.answered());
  EXPECT_EQ(mine.failed(), whole.failed());
  EXPECT_EQ(mine.outcomes(), whole.outcomes());
  EXPECT_EQ(mine.latency().Percentile(50), whole.latency().Percentile(50));
  EXPECT_EQ(mine.lateness().Sum(), whole.lateness().Sum());
  EXPECT_THAT(SumsOf(mine), ::testing::UnorderedElementsAreArray(SumsOf(whole)));
  const auto& errors = mine.errors().at(absl::StatusCode::kInternal);
  EXPECT_EQ(errors.count, whole.errors().at(absl::StatusCode::kInternal).count);
  EXPECT_EQ(errors.longest, whole.errors().at(absl::StatusCode::kInternal).longest);
}

}  // namespace
}  // namespace graspdb::lab
