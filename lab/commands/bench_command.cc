#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "client/cli/base/cache_text.h"
#include "client/cli/base/progress_line.h"
#include "lab/commands/bench_frames.h"
#include "lab/commands/commands.h"
#include "lab/load/load_report.h"
#include "lab/load/load_run.h"

namespace graspdb::lab {
namespace {

struct BenchOptions {
  BenchFrames frames;
  int concurrency = 1;
  double rate = 0;
  std::int64_t requests = 0;
  double duration_s = 0;
  std::int64_t warmup = -1;
};

constexpr double kUsualDurationS = 10;
constexpr std::int64_t kMaxUsualWarmup = 100;

constexpr char kBenchDescription[] =
    "Measure latency and throughput of the server under load.\n"
    "Without --rate (a closed loop), each of --concurrency callers sends the next request as soon "
    "as it has its answer. With --rate (an open loop), requests are due at that rate, evenly "
    "spaced like the frames of a camera, and latency is measured from the due time, so that a "
    "server that falls behind shows in the percentiles.";

constexpr char kBenchFooter[] =
    R"(The frames are sent in turn. Failed requests are not retried. The steps are those that
the server reports in its answers; "network and queue" is the rest of the time between
sending and answer, including the wait for a free worker of the server.

With --json the whole report is one line. Ctrl-C ends the run early and prints the report.
Exit status: 0 when a request was answered, also if others failed.

Examples:
  graspdb bench --simulate                             # ten seconds, one caller
  graspdb bench captures/monday --split QUERY --concurrency 4 --requests 1000
  graspdb bench --simulate --rate 30 --concurrency 8 --duration 60   # a camera's pace
  graspdb bench --simulate --parts handle,wedge --json | jq .latency)";

std::chrono::nanoseconds Seconds(double s) {
  return std::chrono::nanoseconds(std::llround(s * 1e9));
}

LoadPlan PlanOf(const BenchOptions& options) {
  LoadPlan plan;
  plan.concurrency = options.concurrency;
  plan.rate = options.rate;
  plan.requests = options.requests;
  const bool endless = options.requests == 0 && options.duration_s == 0;
  plan.duration = Seconds(endless ? kUsualDurationS : options.duration_s);
  return plan;
}

// Progress in requests or in seconds.
std::function<void(std::int64_t, std::chrono::nanoseconds)> ReportOn(const LoadPlan& plan,
                                                                     client::ProgressLine* line) {
  return [&plan, line](std::int64_t requests, std::chrono::nanoseconds elapsed) {
    if (plan.requests > 0) {
      line->Report(static_cast<int>(requests), static_cast<int>(plan.requests));
      return;
    }
    const auto whole = [](std::chrono::nanoseconds time) {
      return static_cast<int>(std::chrono::duration_cast<std::chrono::seconds>(time).count());
    };
    line->Report(std::min(whole(elapsed), whole(plan.duration)), whole(plan.duration));
  };
}

// The first requests create models and connections, which is not measured.
std::int64_t WarmupOf(const BenchOptions& options, std::size_t frames) {
  if (options.warmup >= 0) return options.warmup;
  return std::min(static_cast<std::int64_t>(frames), kMaxUsualWarmup);
}

LoadResult Measure(const LoadReport& report, const SendRequest& send) {
  if (report.warmup > 0) {
    LoadPlan warmup;
    warmup.concurrency = report.plan.concurrency;
    warmup.requests = report.warmup;
    RunLoad(warmup, send, {.report = {}, .cancelled = client::Interrupted});
  }
  client::ProgressLine line(report.plan.requests > 0 ? "requests" : "seconds");
  return RunLoad(report.plan, send,
                 {.report = ReportOn(report.plan, &line), .cancelled = client::Interrupted});
}

absl::Status PrintReport(const client::GlobalOptions& global, const LoadReport& report) {
  if (!global.json) {
    std::printf("%s", LoadText(report).c_str());
    return absl::OkStatus();
  }
  ASSIGN_OR_RETURN(std::string json, LoadJson(report));
  std::printf("%s\n", json.c_str());
  return absl::OkStatus();
}

// A run without an answer fails with its most frequent error.
absl::Status Verdict(const LoadResult& result) {
  if (result.tally.answered() > 0) return absl::OkStatus();
  const auto& errors = result.tally.errors();
  if (errors.empty()) return absl::CancelledError("interrupted before the first answer");
  const auto most = std::max_element(errors.begin(), errors.end(), [](auto& a, auto& b) {
    return a.second.count < b.second.count;
  });
  return {most->first, absl::StrCat("no request was answered: ", most->second.example)};
}

// One connection per worker, like that many robots. Frames of half a megabyte also delay each other
// on one connection: with two workers and answers of half a millisecond, one connection gave 1310
// answers a second, and two gave 1410.
absl::Status RunBench(const client::GlobalOptions& global, const BenchOptions& options) {
  (void)client::Interrupted();  // installs the handler for Ctrl-C
  client::ConnectionOptions connection{.server = global.server,
                                       .timeout = absl::Seconds(global.timeout_s),
                                       .retry = false,
                                       .own_connection = true,
                                       .security = global.security};
  std::vector<client::Client> clients;
  clients.reserve(static_cast<std::size_t>(options.concurrency));
  for (int i = 0; i < options.concurrency; ++i) clients.emplace_back(connection);

  LoadReport report;
  // With the default deadline: --timeout applies to the requests.
  ASSIGN_OR_RETURN(
      report.catalog,
      client::Connect({.server = global.server, .security = global.security}).GetCatalogStatus());
  ASSIGN_OR_RETURN(const std::vector<v1::RecognizeRequest> requests, MakeRequests(options.frames));
  if (client::Interrupted()) return absl::CancelledError("interrupted before the first request");
  report.server = global.server;
  report.frames = DescribeRequests(requests);
  report.warmup = WarmupOf(options, requests.size());
  report.timeout_s = global.timeout_s;
  report.plan = PlanOf(options);
  report.result = Measure(report, [&](int worker, std::int64_t request) {
    return clients[static_cast<std::size_t>(worker)].Recognize(
        requests[static_cast<std::size_t>(request) % requests.size()]);
  });
  // If the server is gone by now, the report lists the errors.
  const absl::StatusOr<v1::CatalogStatus> after =
      client::Connect({.server = global.server, .security = global.security}).GetCatalogStatus();
  if (after.ok())
    report.models = client::Between(report.catalog.model_cache(), after->model_cache());
  RETURN_IF_ERROR(PrintReport(global, report));
  std::fflush(stdout);
  return Verdict(report.result);
}

void AddLoadOptions(CLI::App& command, BenchOptions* o) {
  command.add_option("--concurrency", o->concurrency, "Maximum number of requests in flight")
      ->check(CLI::Range(1, 1000))
      ->type_name("N")
      ->capture_default_str();
  command
      .add_option("--rate", o->rate,
                  "Requests a second, evenly spaced; default: each follows an answer")
      ->check(CLI::Range(0.001, 1e6))
      ->type_name("R");
  command.add_option("--requests", o->requests, "End after this many requests")
      ->check(CLI::Range(1, 1'000'000'000))
      ->type_name("N");
  command
      .add_option("--duration", o->duration_s,
                  "End after this many seconds; default: 10 without --requests. With both, "
                  "the first limit ends the run")
      ->check(CLI::Range(0.001, 1e6))
      ->type_name("S");
  command
      .add_option("--warmup", o->warmup,
                  "Uncounted requests before the run; default: every frame once, at most 100")
      ->check(CLI::Range(0, 1'000'000))
      ->type_name("N");
}

}  // namespace

void AddBenchCommand(CLI::App& app, const client::GlobalOptions& global, client::Action* action) {
  CLI::App* command = client::AddCommand(app, "bench", kBenchDescription);
  auto options = std::make_shared<BenchOptions>();
  AddFrameOptions(*command, &options->frames);
  AddLoadOptions(*command, options.get());
  command->footer(kBenchFooter);
  command->callback([=, &global] {
    const bool scans = !options->frames.inputs.empty();
    if (scans == options->frames.simulate) {
      throw CLI::ValidationError("bench", "give either SCANs or --simulate");
    }
    *action = [=, &global] { return RunBench(global, *options); };
  });
}

}  // namespace graspdb::lab
