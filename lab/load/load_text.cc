#include <algorithm>
#include <cmath>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cli/base/cache_text.h"
#include "lab/load/load_report.h"

namespace graspdb::lab {
namespace {

constexpr double kBarWidth = 40;

std::string HeaderText(const LoadReport& report) {
  std::string out =
      absl::StrFormat("server   graspdb %s at %s, %d objects, %d views\nframes   %s\n",
                      report.catalog.server_version(), report.server, report.catalog.object_count(),
                      report.catalog.view_count(), report.frames);
  if (report.plan.rate > 0) {
    absl::StrAppendFormat(&out, "load     %g requests/s, evenly spaced, at most %d in flight\n",
                          report.plan.rate, report.plan.concurrency);
  } else {
    absl::StrAppendFormat(&out, "load     %d in flight, the next as soon as one is answered\n",
                          report.plan.concurrency);
  }
  return out;
}

std::string CountsText(const LoadResult& result) {
  const Tally& tally = result.tally;
  std::string out = absl::StrFormat(
      "\n%d requests in %.2f s: %d answered (%.2f/s), %d failed%s\n",
      tally.answered() + tally.failed(), Milliseconds(result.elapsed) / 1000, tally.answered(),
      result.RequestsPerSecond(), tally.failed(), result.cancelled ? "; interrupted" : "");
  for (const auto& [status, count] : tally.outcomes()) {
    absl::StrAppendFormat(&out, "  %-20s %8d\n", status, count);
  }
  for (const auto& [code, failed] : tally.errors()) {
    absl::StrAppendFormat(&out, "  %-20s %8d  up to %.1f ms, e.g.: %s\n",
                          absl::StatusCodeToString(code), failed.count,
                          Milliseconds(failed.longest), failed.example);
  }
  return out;
}

std::string ScheduleText(const LoadPlan& plan, const LoadResult& result) {
  if (plan.rate == 0) return "";
  const LatencyHistogram& lateness = result.tally.lateness();
  const std::int64_t late = lateness.count() - lateness.CountBelow(kLate);
  std::string out = absl::StrFormat(
      "  sent more than %d ms late: %d, the latest by %.1f ms; due and not sent at the end: %d\n",
      kLate.count(), late, Milliseconds(lateness.Max()), result.backlog);
  if (!KeptRate(plan, result)) {
    absl::StrAppendFormat(&out,
                          "  THE RATE OF %g/s WAS NOT KEPT: all %d callers were busy and requests "
                          "queued, so that\n  latencies grow with the length of the run; raise "
                          "--concurrency or lower --rate\n",
                          plan.rate, plan.concurrency);
  }
  return out;
}

std::string LatencyText(const LoadPlan& plan, const LatencyHistogram& latency) {
  std::string heads;
  std::string numbers;
  const auto column = [&](const std::string& head, std::chrono::nanoseconds time) {
    absl::StrAppendFormat(&heads, " %9s", head);
    absl::StrAppendFormat(&numbers, " %9.3f", Milliseconds(time));
  };
  column("min", latency.Min());
  column("mean", latency.Mean());
  for (const double percent : {50.0, 90.0, 99.0, 99.9}) {
    column(absl::StrFormat("p%g", percent), latency.Percentile(percent));
  }
  column("max", latency.Max());
  std::string out = absl::StrCat("\nlatency, ms, ",
                                 plan.rate > 0 ? "from when a request was due" : "from the request",
                                 " to its answer\n", heads, "\n", numbers, "\n\n");
  const std::vector<LatencyBin> bins = BinsOf(latency);
  std::int64_t most = 1;
  for (const LatencyBin& bin : bins) most = std::max(most, bin.count);
  for (const LatencyBin& bin : bins) {
    const double length = kBarWidth * static_cast<double>(bin.count) / static_cast<double>(most);
    absl::StrAppendFormat(&out, " %9.3f to %9.3f %8d %s\n", Milliseconds(bin.from),
                          Milliseconds(bin.to), bin.count,
                          std::string(static_cast<std::size_t>(std::lround(length)), '#'));
  }
  return out;
}

std::string StepsText(const LoadPlan& plan, const Tally& tally) {
  std::string out = absl::StrFormat("\n%-24s %9s %9s %9s %7s\n", "where the time went", "mean ms",
                                    "p50 ms", "p99 ms", "share");
  for (const Step& step : tally.steps()) {
    if (plan.rate == 0 && step.name == kBeforeSending) continue;  // nothing waits there
    absl::StrAppendFormat(&out, "%-24s %9.3f %9.3f %9.3f %5.1f %%\n",
                          (step.in_server ? "  " : "") + step.name, Milliseconds(step.times.Mean()),
                          Milliseconds(step.times.Percentile(50)),
                          Milliseconds(step.times.Percentile(99)), 100 * ShareOf(step, tally));
  }
  return out;
}

// Empty if the server needed no models or did not report them.
std::string ModelsText(const v1::CacheStatus& models) {
  if (models.hit_count() + models.miss_count() == 0) return "";
  const std::string advice = client::CacheAdvice(models);
  return absl::StrCat("\nmodels in memory         ", client::CacheText(models), "\n",
                      advice.empty() ? "" : absl::StrCat("  ", advice, "\n"));
}

}  // namespace

std::string LoadText(const LoadReport& report) {
  const Tally& tally = report.result.tally;
  std::string out = absl::StrCat(HeaderText(report), CountsText(report.result),
                                 ScheduleText(report.plan, report.result));
  if (tally.answered() == 0) return out;
  absl::StrAppend(&out, LatencyText(report.plan, tally.latency()), StepsText(report.plan, tally),
                  ModelsText(report.models));
  return out;
}

}  // namespace graspdb::lab
