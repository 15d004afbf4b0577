#include "lab/load/load_report.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cli/base/cache_text.h"
#include "files/base/json_object.h"

namespace graspdb::lab {
namespace {

// A request sent later than this after its due time is late.
constexpr std::chrono::milliseconds kLate{1};

double Milliseconds(std::chrono::nanoseconds time) {
  return std::chrono::duration<double, std::milli>(time).count();
}

// Share of a step in the latency of all requests, also of those without it; 0 to 1.
double ShareOf(const Step& step, const Tally& tally) {
  const double all = Milliseconds(tally.latency().Sum());
  return all > 0 ? Milliseconds(step.times.Sum()) / all : 0;
}

constexpr int kBins = 10;

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

void FillPlan(const LoadReport& report, files::JsonObject out) {
  out.Set(files::Json("loop", report.plan.rate > 0 ? "open" : "closed"),
          files::Json("concurrency", report.plan.concurrency),
          files::Json("rate_per_s", report.plan.rate),
          files::Json("requests", report.plan.requests),
          files::Json("duration_s", Milliseconds(report.plan.duration) / 1000),
          files::Json("warmup_requests", report.warmup), files::Json("timeout_s", report.timeout_s),
          files::Json("frames", report.frames));
}

void FillServer(const LoadReport& report, files::JsonObject out) {
  out.Set(files::Json("address", report.server),
          files::Json("version", report.catalog.server_version()),
          files::Json("objects", report.catalog.object_count()),
          files::Json("views", report.catalog.view_count()));
  const v1::CacheStatus& models = report.models;
  out.Object("models").Set(
      files::Json("found", models.hit_count()), files::Json("made", models.miss_count()),
      files::Json("bytes", models.byte_count()), files::Json("byte_budget", models.byte_budget()));
}

void FillSchedule(const LoadReport& report, files::JsonObject out) {
  const LatencyHistogram& lateness = report.result.tally.lateness();
  out.Set(files::Json("rate_kept", KeptRate(report.plan, report.result)),
          files::Json("not_sent", report.result.backlog),
          files::Json("late_requests", lateness.count() - lateness.CountBelow(kLate)),
          files::Json("latest_ms", Milliseconds(lateness.Max())));
}

// The keys of one histogram; no times if it is empty.
void FillTimes(const LatencyHistogram& times, files::JsonObject out) {
  out.Set(files::Json("count", times.count()));
  if (times.count() == 0) return;
  out.Set(files::Json("min_ms", Milliseconds(times.Min())),
          files::Json("mean_ms", Milliseconds(times.Mean())),
          files::Json("max_ms", Milliseconds(times.Max())));
  out.List("percentiles", kPercentiles, [&](double percent, files::JsonObject rung) {
    rung.Set(files::Json("percent", percent),
             files::Json("ms", Milliseconds(times.Percentile(percent))));
  });
}

// Without the step before sending in a closed loop, where nothing waits.
std::vector<Step> StepsOf(const LoadReport& report) {
  std::vector<Step> out = report.result.tally.steps();
  if (report.plan.rate == 0)
    std::erase_if(out, [](const Step& step) { return step.name == kBeforeSending; });
  return out;
}

}  // namespace

std::vector<LatencyBin> BinsOf(const LatencyHistogram& histogram) {
  std::vector<LatencyBin> out;
  if (histogram.count() == 0) return out;
  const std::chrono::nanoseconds low = histogram.Min();
  const std::chrono::nanoseconds width = (histogram.Percentile(99) - low) / kBins;
  std::int64_t below = 0;
  for (int i = 0; i < kBins && width.count() > 0; ++i) {
    const std::chrono::nanoseconds end = low + width * (i + 1);
    const std::int64_t now = histogram.CountBelow(end);
    out.push_back({low + width * i, end, now - below});
    below = now;
  }
  const std::chrono::nanoseconds last = out.empty() ? low : out.back().to;
  if (below < histogram.count()) {
    out.push_back({last, histogram.Max(), histogram.count() - below});
  }
  return out;
}

absl::StatusOr<std::string> LoadJson(const LoadReport& report) {
  const Tally& tally = report.result.tally;
  google::protobuf::Struct document;
  files::JsonObject out(&document);
  FillServer(report, out.Object("server"));
  FillPlan(report, out.Object("plan"));
  out.Set(files::Json("elapsed_s", Milliseconds(report.result.elapsed) / 1000),
          files::Json("interrupted", report.result.cancelled),
          files::Json("answered", tally.answered()), files::Json("failed", tally.failed()),
          files::Json("answered_per_s", report.result.RequestsPerSecond()));
  if (report.plan.rate > 0) FillSchedule(report, out.Object("schedule"));
  files::JsonObject outcomes = out.Object("outcomes");
  for (const auto& [status, count] : tally.outcomes()) outcomes.Set(files::Json(status, count));
  out.List("errors", tally.errors(), [](const auto& error, files::JsonObject object) {
    const auto& [code, failed] = error;
    object.Set(files::Json("code", absl::StatusCodeToString(code)),
               files::Json("count", failed.count),
               files::Json("longest_ms", Milliseconds(failed.longest)),
               files::Json("example", failed.example));
  });
  FillTimes(tally.latency(), out.Object("latency"));
  out.List(
      "histogram", BinsOf(tally.latency()), [](const LatencyBin& bin, files::JsonObject object) {
        object.Set(files::Json("from_ms", Milliseconds(bin.from)),
                   files::Json("to_ms", Milliseconds(bin.to)), files::Json("count", bin.count));
      });
  out.List("steps", StepsOf(report), [&](const Step& step, files::JsonObject object) {
    object.Set(files::Json("step", step.name), files::Json("in_server", step.in_server),
               files::Json("share", ShareOf(step, tally)));
    FillTimes(step.times, object);
  });
  return files::PrintDocument(document, files::JsonLayout::kOneLine);
}

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
