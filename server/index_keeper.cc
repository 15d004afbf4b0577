#include "server/index_keeper.h"

#include <spdlog/spdlog.h>

#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "logging/log_field.h"
#include "server/background.h"
#include "server/index_snapshot.h"

namespace graspdb::server {
namespace {

// Quiet: no change from one look to the next.
constexpr absl::Duration kBetweenLooks = absl::Seconds(10);
// A start reads so many changed records in some 50 ms.
constexpr std::int64_t kWorthWriting = 2'000;

}  // namespace

IndexKeeper::IndexKeeper(const storage::Catalogue& catalogue, LiveCatalogue& live,
                         const recognition::DescriptorParameters& parameters)
    : catalogue_(catalogue),
      live_(live),
      parameters_(parameters),
      written_(live.file_revision().value_or(0)),
      thread_([this, has_file = live.file_revision().has_value()] {
        GiveWay();
        if (!has_file) WriteIfBehind(1);
        Watch();
      }) {}

IndexKeeper::~IndexKeeper() {
  {
    absl::MutexLock lock(&mutex_);
    stop_ = true;
  }
  thread_.join();
  WriteIfBehind(1);
}

void IndexKeeper::Watch() {
  for (std::int64_t seen = -1; !Stopped(kBetweenLooks);) {
    live_.CatchUp();
    const std::int64_t now = live_.snapshot()->revision;
    if (now == seen) WriteIfBehind(kWorthWriting);
    seen = now;
  }
}

bool IndexKeeper::Stopped(absl::Duration wait) {
  absl::MutexLock lock(&mutex_);
  mutex_.AwaitWithTimeout(absl::Condition(&stop_), wait);
  return stop_;
}

void IndexKeeper::WriteIfBehind(std::int64_t changes) {
  const auto snapshot = live_.snapshot();
  if (snapshot->revision - written_ < changes) return;
  // Where it fails, the next try waits for more changes.
  written_ = snapshot->revision;
  const absl::Time begin = absl::Now();
  const absl::Status status = WriteIndexSnapshot(catalogue_, *snapshot, parameters_);
  if (!status.ok()) {
    spdlog::warn("event=index_not_written revision={} error={}", snapshot->revision,
                 LogField(std::string(status.message())));
    return;
  }
  spdlog::info("event=index_written revision={} views={} ms={}", snapshot->revision,
               snapshot->index.view_count(), absl::ToInt64Milliseconds(absl::Now() - begin));
}

}  // namespace graspdb::server
