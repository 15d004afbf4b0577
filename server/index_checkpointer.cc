#include "server/index_checkpointer.h"

#include <spdlog/spdlog.h>

#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "program/log_field.h"
#include "server/index_snapshot.h"

namespace graspdb::server {
namespace {

// A start reads this many changed records in some 50 ms.
constexpr std::int64_t kWorthWriting = 2'000;

}  // namespace

IndexCheckpointer::IndexCheckpointer(const storage::Catalogue& catalogue, LiveCatalogue& live,
                                     const recognition::DescriptorParameters& parameters)
    : catalogue_(catalogue),
      live_(live),
      parameters_(parameters),
      written_(live.file_revision().value_or(0)) {
  const bool has_file = live.file_revision().has_value();
  idle_task_.emplace(
      live,
      [this, has_file] {
        if (!has_file) WriteIfBehind(1);
      },
      [this] { WriteIfBehind(kWorthWriting); });
}

IndexCheckpointer::~IndexCheckpointer() {
  idle_task_.reset();
  WriteIfBehind(1);
}

void IndexCheckpointer::WriteIfBehind(std::int64_t changes) {
  const auto snapshot = live_.snapshot();
  if (snapshot->revision - written_ < changes) return;
  // If it fails, the next try waits for more changes.
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
