#include <google/protobuf/struct.pb.h>

#include "files/json_object.h"
#include "lab/load/load_report.h"

namespace graspdb::client {
namespace {

using google::protobuf::Struct;
using google::protobuf::Value;

void FillPlan(const LoadReport& report, Value* value) {
  JsonObject out(value);
  out.Text("loop", report.plan.rate > 0 ? "open" : "closed");
  out.Number("concurrency", report.plan.concurrency);
  out.Number("rate_per_s", report.plan.rate);
  out.Number("requests", static_cast<double>(report.plan.requests));
  out.Number("duration_s", Milliseconds(report.plan.duration) / 1000);
  out.Number("warmup_requests", static_cast<double>(report.warmup));
  out.Number("timeout_s", report.timeout_s);
  out.Text("frames", report.frames);
}

void FillServer(const LoadReport& report, Value* value) {
  JsonObject out(value);
  out.Text("address", report.server);
  out.Text("version", report.catalog.server_version());
  out.Number("objects", static_cast<double>(report.catalog.object_count()));
  out.Number("views", static_cast<double>(report.catalog.view_count()));
  JsonObject models(&out.At("models"));
  models.Number("found", static_cast<double>(report.models.hit_count()));
  models.Number("made", static_cast<double>(report.models.miss_count()));
  models.Number("bytes", static_cast<double>(report.models.byte_count()));
  models.Number("byte_budget", static_cast<double>(report.models.byte_budget()));
}

void FillSchedule(const LoadReport& report, Value* value) {
  const LatencyHistogram& lateness = report.result.tally.lateness();
  JsonObject out(value);
  out.Bool("rate_kept", KeptRate(report.plan, report.result));
  out.Number("not_sent", static_cast<double>(report.result.backlog));
  out.Number("late_requests", static_cast<double>(lateness.count() - lateness.CountBelow(kLate)));
  out.Number("latest_ms", Milliseconds(lateness.Max()));
}

void FillErrors(const Tally& tally, Value* value) {
  auto* list = value->mutable_list_value();
  for (const auto& [code, failed] : tally.errors()) {
    JsonObject out(list->add_values());
    out.Text("code", absl::StatusCodeToString(code));
    out.Number("count", static_cast<double>(failed.count));
    out.Number("longest_ms", Milliseconds(failed.longest));
    out.Text("example", failed.example);
  }
}

// The keys of one histogram; no times if it is empty.
void FillTimes(const LatencyHistogram& times, JsonObject* out) {
  out->Number("count", static_cast<double>(times.count()));
  if (times.count() == 0) return;
  out->Number("min_ms", Milliseconds(times.Min()));
  out->Number("mean_ms", Milliseconds(times.Mean()));
  out->Number("max_ms", Milliseconds(times.Max()));
  auto* ladder = out->At("percentiles").mutable_list_value();
  for (const double percent : kPercentiles) {
    JsonObject rung(ladder->add_values());
    rung.Number("percent", percent);
    rung.Number("ms", Milliseconds(times.Percentile(percent)));
  }
}

void FillBins(const LatencyHistogram& latency, Value* value) {
  auto* list = value->mutable_list_value();
  for (const LatencyBin& bin : BinsOf(latency)) {
    JsonObject out(list->add_values());
    out.Number("from_ms", Milliseconds(bin.from));
    out.Number("to_ms", Milliseconds(bin.to));
    out.Number("count", static_cast<double>(bin.count));
  }
}

void FillSteps(const LoadPlan& plan, const Tally& tally, Value* value) {
  auto* list = value->mutable_list_value();
  for (const Step& step : tally.steps()) {
    if (plan.rate == 0 && step.name == kBeforeSending) continue;  // nothing waits there
    JsonObject out(list->add_values());
    out.Text("step", step.name);
    out.Bool("in_server", step.in_server);
    out.Number("share", ShareOf(step, tally));
    FillTimes(step.times, &out);
  }
}

}  // namespace

absl::StatusOr<std::string> LoadJson(const LoadReport& report) {
  const Tally& tally = report.result.tally;
  Struct document;
  JsonObject out(&document);
  FillServer(report, &out.At("server"));
  FillPlan(report, &out.At("plan"));
  out.Number("elapsed_s", Milliseconds(report.result.elapsed) / 1000);
  out.Bool("interrupted", report.result.cancelled);
  out.Number("answered", static_cast<double>(tally.answered()));
  out.Number("failed", static_cast<double>(tally.failed()));
  out.Number("answered_per_s", report.result.RequestsPerSecond());
  if (report.plan.rate > 0) FillSchedule(report, &out.At("schedule"));
  JsonObject outcomes(&out.At("outcomes"));
  for (const auto& [status, count] : tally.outcomes()) {
    outcomes.Number(status, static_cast<double>(count));
  }
  FillErrors(tally, &out.At("errors"));
  JsonObject latency(&out.At("latency"));
  FillTimes(tally.latency(), &latency);
  FillBins(tally.latency(), &out.At("histogram"));
  FillSteps(report.plan, tally, &out.At("steps"));
  return PrintDocument(document, JsonLayout::kOneLine);
}

}  // namespace graspdb::client
