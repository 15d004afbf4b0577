#include "client/cell/blackbox/black_box.h"

#include <spdlog/spdlog.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <string>
#include <system_error>
#include <utility>

#include "absl/time/time.h"
#include "base/status_macros.h"
#include "program/log/log_field.h"

namespace graspdb::client {
namespace {

constexpr int kNiceness = 10;

absl::Time TimeOf(const v1::Bundle& bundle) {
  return absl::FromUnixSeconds(bundle.request_time().seconds()) +
         absl::Nanoseconds(bundle.request_time().nanos());
}

}  // namespace

bool IsTroubled(const v1::Bundle& bundle, double low_score) {
  if (!bundle.has_response() || bundle.response().status() != v1::OK) return true;
  double best = 0;
  for (const v1::Detection& detection : bundle.response().detections()) {
    if (detection.status() == v1::OK) best = std::max(best, detection.score());
  }
  return best < low_score;
}

absl::StatusOr<std::unique_ptr<BlackBox>> BlackBox::Open(const BlackBoxOptions& options) {
  ASSIGN_OR_RETURN(BundleRing ring, BundleRing::Open(options.ring));
  std::unique_ptr<BlackBox> out(new BlackBox(std::move(ring), options.max_waiting));
  try {
    out->thread_ = std::thread([box = out.get()] { box->WriteAll(); });
  } catch (const std::system_error&) {
    return absl::ResourceExhaustedError("no thread is left; check the system's limits");
  }
  return out;
}

BlackBox::BlackBox(BundleRing ring, std::size_t max_waiting)
    : ring_(std::move(ring)), max_waiting_(max_waiting) {}

BlackBox::~BlackBox() {
  {
    absl::MutexLock lock(&mutex_);
    stop_ = true;
    changed_.SignalAll();
  }
  if (thread_.joinable()) thread_.join();
}

bool BlackBox::Keep(v1::Bundle bundle) {
  {
    absl::MutexLock lock(&mutex_);
    if (waiting_.size() >= max_waiting_) {
      ++counts_.dropped;
      return false;
    }
    waiting_.push_back(std::move(bundle));
  }
  changed_.SignalAll();  // after unlocking, so that the woken thread can lock
  return true;
}

void BlackBox::Flush() {
  absl::MutexLock lock(&mutex_);
  while (writing_ || !waiting_.empty()) changed_.Wait(&mutex_);
}

BlackBoxCounts BlackBox::counts() const {
  absl::MutexLock lock(&mutex_);
  return counts_;
}

absl::Status BlackBox::Write(const v1::Bundle& bundle) {
  ASSIGN_OR_RETURN(const std::string bytes, BundleBytes(bundle));
  return ring_.Add(bytes, TimeOf(bundle));
}

void BlackBox::WriteAll() {
  // Lower priority than the threads that call Keep. On Linux the niceness is per thread, and
  // raising it always succeeds.
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNiceness);
  absl::StatusCode last_failure = absl::StatusCode::kOk;
  for (;;) {
    v1::Bundle next;
    {
      absl::MutexLock lock(&mutex_);
      while (waiting_.empty() && !stop_) changed_.Wait(&mutex_);
      if (waiting_.empty()) return;
      next = std::move(waiting_.front());
      waiting_.pop_front();
      writing_ = true;
    }
    const absl::Status written = Write(next);
    // Logged once per reason: the log must not fill a full disk further.
    if (!written.ok() && written.code() != last_failure) {
      spdlog::warn("event=bundle_not_kept error={}", LogField(std::string(written.message())));
    }
    last_failure = written.code();
    absl::MutexLock lock(&mutex_);
    ++(written.ok() ? counts_.kept : counts_.failed);
    writing_ = false;
    changed_.SignalAll();
  }
}

}  // namespace graspdb::client
