#include "files/base/json_object.h"
#include "lab/load/load_report.h"

namespace graspdb::lab {
namespace {

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

}  // namespace graspdb::lab
