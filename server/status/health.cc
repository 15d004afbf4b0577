#include "server/status/health.h"

#include <grpcpp/health_check_service_interface.h>
#include <spdlog/spdlog.h>

#include <string>
#include <utility>

#include "absl/time/clock.h"
#include "program/log/log_field.h"
#include "server/base/background.h"

namespace graspdb::server {
namespace {

void LogEnd(const storage::WriteFault& fault) {
  spdlog::info("event=writes_resumed seconds={:.0f}",
               absl::ToDoubleSeconds(absl::Now() - fault.begin));
}

void LogBegin(const storage::WriteFault& fault) {
  spdlog::error("event=writes_failed error={}", LogField(std::string(fault.error.message())));
}

// Follows one state to the next.
class Follower {
 public:
  Follower(storage::Catalogue& catalogue, std::function<void(bool)> report,
           std::atomic<bool>& cancelled)
      : catalogue_(catalogue), report_(std::move(report)), cancelled_(cancelled) {}

  absl::Status Step() {
    catalogue_.CheckWrites(&cancelled_);
    storage::DatabaseStatus status = catalogue_.database_status();
    NoteReserve(std::move(status.reserve_error));
    storage::WriteFault now = std::move(status.write_fault);
    const bool succeed = now.error.ok();
    if (is_first_ || succeed != last_.error.ok()) report_(succeed);
    if (!succeed && last_.error.ok()) LogBegin(now);
    if (succeed && !last_.error.ok()) LogEnd(last_);
    is_first_ = false;
    last_ = std::move(now);
    return absl::OkStatus();
  }

 private:
  void NoteReserve(std::string error) {
    if (!error.empty() && error != reserve_error_) {
      spdlog::warn("event=no_disk_reserve error={}", LogField(error));
    }
    reserve_error_ = std::move(error);
  }

  storage::Catalogue& catalogue_;
  const std::function<void(bool)> report_;
  std::atomic<bool>& cancelled_;
  bool is_first_ = true;
  storage::WriteFault last_;
  std::string reserve_error_;
};

}  // namespace

Health::Health(LiveCatalogue& live, grpc::Server& server) : live_(live), server_(server) {
  live_.ReportAgreement([health = server_.GetHealthCheckService()](bool agrees) {
    // Of the whole server alone: without a name it would be that of graspdb.writes as well.
    health->SetServingStatus("", agrees);
  });
}

Health::~Health() { live_.ReportAgreement({}); }

void Health::Drain() { server_.GetHealthCheckService()->Shutdown(); }

WriteWatch::WriteWatch(storage::Catalogue& catalogue, std::function<void(bool)> report,
                       std::chrono::nanoseconds interval)
    : thread_([this, follower = Follower(catalogue, std::move(report), cancelled_),
               interval]() mutable {
        do {
          const absl::Status done = Guarded([&follower] { return follower.Step(); });
          if (!done.ok()) {
            spdlog::error("event=write_watch_failed error={}",
                          LogField(std::string(done.message())));
          }
        } while (!stop_.Wait(interval));
      }) {}

WriteWatch::~WriteWatch() {
  cancelled_ = true;  // a compaction of minutes
  stop_.Raise();
  thread_.join();
}

}  // namespace graspdb::server
