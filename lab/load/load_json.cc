#include "files/json_object.h"
#include "lab/load/load_report.h"

namespace graspdb::client {
namespace {

void FillPlan(const LoadReport& report, JsonObject out) {
  out.Set(Json("loop", report.plan.rate > 0 ? "open" : "closed"),
          Json("concurrency", report.plan.concurrency), Json("rate_per_s", report.plan.rate),
          Json("requests", report.plan.requests),
          Json("duration_s", Milliseconds(report.plan.duration) / 1000),
          Json("warmup_requests", report.warmup), Json("timeout_s", report.timeout_s),
          Json("frames", report.frames));
}

void FillServer(const LoadReport& report, JsonObject out) {
  out.Set(Json("address", report.server), Json("version", report.catalog.server_version()),
          Json("objects", report.catalog.object_count()),
          Json("views", report.catalog.view_count()));
  const v1::CacheStatus& models = report.models;
  out.Object("models").Set(Json("found", models.hit_count()), Json("made", models.miss_count()),
                           Json("bytes", models.byte_count()),
                           Json("byte_budget", models.byte_budget()));
}

void FillSchedule(const LoadReport& report, JsonObject out) {
  const LatencyHistogram& lateness = report.result.tally.lateness();
  out.Set(Json("rate_kept", KeptRate(report.plan, report.result)),
          Json("not_sent", report.result.backlog),
          Json("late_requests", lateness.count() - lateness.CountBelow(kLate)),
          Json("latest_ms", Milliseconds(lateness.Max())));
}

// The keys of one histogram; no times if it is empty.
void FillTimes(const LatencyHistogram& times, JsonObject out) {
  out.Set(Json("count", times.count()));
  if (times.count() == 0) return;
  out.Set(Json("min_ms", Milliseconds(times.Min())), Json("mean_ms", Milliseconds(times.Mean())),
          Json("max_ms", Milliseconds(times.Max())));
  out.List("percentiles", kPercentiles, [&](double percent, JsonObject rung) {
    rung.Set(Json("percent", percent), Json("ms", Milliseconds(times.Percentile(percent))));
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
  JsonObject out(&document);
  FillServer(report, out.Object("server"));
  FillPlan(report, out.Object("plan"));
  out.Set(Json("elapsed_s", Milliseconds(report.result.elapsed) / 1000),
          Json("interrupted", report.result.cancelled), Json("answered", tally.answered()),
          Json("failed", tally.failed()),
          Json("answered_per_s", report.result.RequestsPerSecond()));
  if (report.plan.rate > 0) FillSchedule(report, out.Object("schedule"));
  JsonObject outcomes = out.Object("outcomes");
  for (const auto& [status, count] : tally.outcomes()) outcomes.Set(Json(status, count));
  out.List("errors", tally.errors(), [](const auto& error, JsonObject object) {
    const auto& [code, failed] = error;
    object.Set(Json("code", absl::StatusCodeToString(code)), Json("count", failed.count),
               Json("longest_ms", Milliseconds(failed.longest)), Json("example", failed.example));
  });
  FillTimes(tally.latency(), out.Object("latency"));
  out.List("histogram", BinsOf(tally.latency()), [](const LatencyBin& bin, JsonObject object) {
    object.Set(Json("from_ms", Milliseconds(bin.from)), Json("to_ms", Milliseconds(bin.to)),
               Json("count", bin.count));
  });
  out.List("steps", StepsOf(report), [&](const Step& step, JsonObject object) {
    object.Set(Json("step", step.name), Json("in_server", step.in_server),
               Json("share", ShareOf(step, tally)));
    FillTimes(step.times, object);
  });
  return PrintDocument(document, JsonLayout::kOneLine);
}

}  // namespace graspdb::client
