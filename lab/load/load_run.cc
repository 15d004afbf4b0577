#include "lab/load/load_run.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace graspdb::lab {
namespace {

using std::chrono::nanoseconds;

nanoseconds FromMilliseconds(double ms) {
  return std::chrono::duration_cast<nanoseconds>(std::chrono::duration<double, std::milli>(ms));
}

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kWatchPause{50};
constexpr std::chrono::milliseconds kNoServerPause{100};
constexpr double kNs = 1e9;  // in a second

// The workers of one run and the thread that watches them.
class Run {
 public:
  Run(const LoadPlan& plan, const SendRequest& send)
      : plan_(plan), send_(send), running_(plan.concurrency) {}

  void Work(int worker);
  // Waits for a short time; false once all workers are done.
  bool Wait();
  void Stop();
  std::int64_t finished() const { return finished_.load(); }
  nanoseconds Elapsed() const { return Clock::now() - start_; }
  LoadResult Result() const;

 private:
  bool IsOver(Clock::time_point now) const;
  nanoseconds DueAfter(std::int64_t request) const;
  std::int64_t DueWithin(nanoseconds time) const;
  bool SleepUntil(Clock::time_point time);
  // When the next request is due, in `times`; false when there is none.
  bool Next(std::int64_t* request, RequestTimes* times);

  const LoadPlan& plan_;
  const SendRequest& send_;
  const Clock::time_point start_ = Clock::now();
  std::atomic<std::int64_t> next_ = 0;
  std::atomic<std::int64_t> finished_ = 0;

  mutable std::mutex mutex_;  // guards the members below
  std::condition_variable changed_;
  int running_;
  bool stopped_ = false;
  Tally tally_;
  Clock::time_point last_sent_ = start_;
  Clock::time_point last_finished_ = start_;
  Clock::time_point stop_time_ = Clock::time_point::max();
};

bool Run::IsOver(Clock::time_point now) const {
  return plan_.duration.count() > 0 && now - start_ >= plan_.duration;
}

nanoseconds Run::DueAfter(std::int64_t request) const {
  return nanoseconds(std::llround(static_cast<double>(request) / plan_.rate * kNs));
}

// Number of requests that are due before `time` has passed.
std::int64_t Run::DueWithin(nanoseconds time) const {
  const double due = std::ceil(static_cast<double>(time.count()) / kNs * plan_.rate);
  const auto count = static_cast<std::int64_t>(due);
  return plan_.requests > 0 ? std::min(plan_.requests, count) : count;
}

// False when the run was stopped meanwhile.
bool Run::SleepUntil(Clock::time_point time) {
  std::unique_lock lock(mutex_);
  return !changed_.wait_until(lock, time, [&] { return stopped_; });
}

bool Run::Next(std::int64_t* request, RequestTimes* times) {
  *request = next_++;
  if (plan_.requests > 0 && *request >= plan_.requests) return false;
  if (plan_.rate > 0) {
    times->due = start_ + DueAfter(*request);
    if (IsOver(times->due)) return false;
  } else {
    times->due = Clock::now();
  }
  if (!SleepUntil(times->due)) return false;
  times->sent = plan_.rate > 0 ? Clock::now() : times->due;
  return !IsOver(times->sent);
}

void Run::Work(int worker) {
  Tally mine;
  std::int64_t request = 0;
  RequestTimes times;
  RequestTimes last = {start_, start_, start_};
  while (Next(&request, &times)) {
    const auto response = send_(worker, request);
    times.finished = Clock::now();
    last = times;
    ++finished_;
    if (response.ok()) {
      mine.AddAnswer(times, *response);
      continue;
    }
    mine.AddError(times, response.status());
    if (plan_.rate == 0 && absl::IsUnavailable(response.status())) {
      SleepUntil(times.finished + kNoServerPause);
    }
  }
  const std::lock_guard lock(mutex_);
  tally_.Merge(mine);
  last_sent_ = std::max(last_sent_, last.sent);
  last_finished_ = std::max(last_finished_, last.finished);
  --running_;
  changed_.notify_all();
}

bool Run::Wait() {
  std::unique_lock lock(mutex_);
  return !changed_.wait_for(lock, kWatchPause, [&] { return running_ == 0; });
}

void Run::Stop() {
  const std::lock_guard lock(mutex_);
  stopped_ = true;
  stop_time_ = Clock::now();
  changed_.notify_all();
}

LoadResult Run::Result() const {
  const std::lock_guard lock(mutex_);
  LoadResult out;
  out.tally = tally_;
  out.elapsed = last_finished_ - start_;
  out.cancelled = stopped_;
  if (plan_.rate == 0) return out;
  // A run for some time ends when that has passed, one of some requests with the last of them.
  const Clock::time_point planned =
      plan_.duration.count() > 0 ? start_ + plan_.duration : Clock::time_point::max();
  const Clock::time_point end = std::min(planned, stop_time_);
  const std::int64_t sent = tally_.lateness().count();
  if (plan_.requests > 0 && sent == plan_.requests) {
    const nanoseconds late = last_sent_ - start_ - DueAfter(sent - 1);
    out.backlog = std::llround(static_cast<double>(late.count()) / kNs * plan_.rate);
  } else {
    out.backlog = std::max<std::int64_t>(0, DueWithin(end - start_) - sent);
  }
  return out;
}

}  // namespace

Step& Tally::StepNamed(const std::string& name, bool in_server) {
  const auto is_it = [&](const Step& s) { return s.name == name && s.in_server == in_server; };
  const auto found = std::find_if(steps_.begin(), steps_.end(), is_it);
  if (found != steps_.end()) return *found;
  return steps_.emplace_back(Step{name, in_server, {}});
}

void Tally::AddAnswer(const RequestTimes& times, const v1::RecognizeResponse& response) {
  latency_.Record(times.finished - times.due);
  lateness_.Record(times.sent - times.due);
  ++outcomes_[v1::RecognitionStatus_Name(response.status())];
  const nanoseconds server = FromMilliseconds(response.timings().total_ms());
  StepNamed(kBeforeSending, false).times.Record(times.sent - times.due);
  StepNamed("network and queue", false).times.Record(times.finished - times.sent - server);
  StepNamed("server in total", false).times.Record(server);
  const auto add = [&](const std::string& name, double ms) {
    const nanoseconds time = FromMilliseconds(ms);
    StepNamed(name, true).times.Record(time);
    return time;
  };
  nanoseconds named = add("decode", response.timings().decode_ms());
  for (const v1::StageReport& stage : response.stages()) {
    named += add(stage.stage(), stage.duration_ms());
  }
  StepNamed("rest", true).times.Record(server - named);
}

void Tally::AddError(const RequestTimes& times, const absl::Status& status) {
  lateness_.Record(times.sent - times.due);
  FailedRequests& failed = errors_[status.code()];
  if (failed.count++ == 0) failed.example = std::string(status.message());
  failed.longest = std::max<nanoseconds>(failed.longest, times.finished - times.due);
}

void Tally::Merge(const Tally& other) {
  latency_.Merge(other.latency_);
  lateness_.Merge(other.lateness_);
  for (const auto& [status, count] : other.outcomes_) outcomes_[status] += count;
  for (const auto& [code, failed] : other.errors_) {
    FailedRequests& mine = errors_[code];
    if (mine.count == 0) mine.example = failed.example;
    mine.count += failed.count;
    mine.longest = std::max(mine.longest, failed.longest);
  }
  for (const Step& step : other.steps_) {
    StepNamed(step.name, step.in_server).times.Merge(step.times);
  }
}

double LoadResult::RequestsPerSecond() const {
  if (elapsed.count() <= 0) return 0;
  return static_cast<double>(tally.answered()) * kNs / static_cast<double>(elapsed.count());
}

bool KeptRate(const LoadPlan& plan, const LoadResult& result) {
  if (plan.rate == 0) return true;
  const auto sent = static_cast<double>(result.tally.lateness().count());
  return static_cast<double>(result.backlog) <= std::max(2.0, 0.02 * sent);
}

LoadResult RunLoad(const LoadPlan& plan, const SendRequest& send, const LoadWatch& watch) {
  Run run(plan, send);
  std::vector<std::thread> workers;
  workers.reserve(static_cast<std::size_t>(plan.concurrency));
  for (int i = 0; i < plan.concurrency; ++i) {
    workers.emplace_back([&run, i] { run.Work(i); });
  }
  bool cancelled = false;
  while (run.Wait()) {
    if (watch.report) watch.report(run.finished(), run.Elapsed());
    if (cancelled || !watch.cancelled || !watch.cancelled()) continue;
    cancelled = true;
    run.Stop();
  }
  for (std::thread& worker : workers) worker.join();
  return run.Result();
}

}  // namespace graspdb::lab
