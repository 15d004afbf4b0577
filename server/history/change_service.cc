#include "server/history/change_service.h"

#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "server/base/errors.h"
#include "server/calls/handle.h"
#include "storage/database/family.h"

namespace graspdb::server {
namespace {

using Clock = std::chrono::steady_clock;  // cannot be set

// Changes that are read at once, if they are small, and resources in one response: with the longest
// names 110 KB.
constexpr std::size_t kChangesAtOnce = 64;
constexpr int kResourcesAtOnce = 500;
constexpr double kHeartbeatS = 30;
constexpr double kMinHeartbeatS = 1;
constexpr double kMaxHeartbeatS = 3600;
// Time in which a cancelled call is noticed.
constexpr std::chrono::milliseconds kCancelNoticed{500};

// Adds the record to `out`; leaves it out where the change record has no values.
void AddRecord(const storage::Mutation& mutation, v1::ResourceChange* out) {
  const std::string& family = mutation.column_family();
  const std::string& value = mutation.value();
  if (value.empty()) return;
  const auto is = [&](storage::Family wanted) { return family == storage::FamilyName(wanted); };
  bool parsed = true;
  if (is(storage::Family::kObjects)) {
    parsed = out->mutable_object()->ParseFromString(value);
  } else if (is(storage::Family::kStablePoses)) {
    parsed = out->mutable_stable_pose()->ParseFromString(value);
  } else if (is(storage::Family::kCells)) {
    parsed = out->mutable_cell()->ParseFromString(value);
  } else if (is(storage::Family::kGraspOutcomes)) {
    storage::GraspOutcomesRecord record;
    parsed = record.ParseFromString(value);
    out->mutable_grasp_outcomes()->mutable_counts()->Swap(record.mutable_counts());
  }
  if (!parsed) out->clear_record();  // damaged: whoever reads it by its name gets DATA_LOSS
}

// A change in as many responses as it takes; clouds are left out, as parts of their views.
std::vector<v1::WatchCatalogResponse> ResponsesTo(const storage::ChangeRecord& change,
                                                  const std::string& catalog_id,
                                                  bool include_records) {
  std::vector<v1::WatchCatalogResponse> out;
  const auto begin = [&] {
    if (!out.empty()) out.back().set_continued(true);
    v1::WatchCatalogResponse& response = out.emplace_back();
    response.set_catalog_id(catalog_id);
    response.set_catalog_revision(change.revision());
    *response.mutable_change_time() = change.time();
  };
  begin();
  for (const storage::Mutation& mutation : change.mutations()) {
    if (mutation.column_family() == storage::FamilyName(storage::Family::kClouds)) continue;
    if (out.back().changes_size() == kResourcesAtOnce) begin();
    v1::ResourceChange& resource = *out.back().add_changes();
    resource.set_name(mutation.key());
    resource.set_kind(mutation.kind() == storage::Mutation::KIND_PUT ? v1::CHANGE_KIND_WRITTEN
                                                                     : v1::CHANGE_KIND_DELETED);
    if (include_records) AddRecord(mutation, &resource);
  }
  return out;
}

// Counts a watcher, also if its call ends by an exception.
class CountedWatcher {
 public:
  explicit CountedWatcher(std::atomic<int>& count) : count_(count), others_(count.fetch_add(1)) {}
  ~CountedWatcher() { count_.fetch_sub(1); }
  CountedWatcher(const CountedWatcher&) = delete;
  CountedWatcher& operator=(const CountedWatcher&) = delete;

  int others() const { return others_; }

 private:
  std::atomic<int>& count_;
  const int others_;
};

absl::StatusOr<Clock::duration> HeartbeatOf(const v1::WatchCatalogRequest& request) {
  const double seconds = request.has_heartbeat_s() ? request.heartbeat_s() : kHeartbeatS;
  // Not a number fails, too.
  if (seconds >= kMinHeartbeatS && seconds <= kMaxHeartbeatS) {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  }
  return InvalidField("heartbeat_s", "must be 1 to 3600");
}

// Whether `revision` is one of this catalogue. `known_id` is empty or the catalogue that the
// watcher means.
absl::Status CheckBegin(const storage::Catalogue& catalogue, const std::string& known_id,
                        std::int64_t revision) {
  if (!known_id.empty() && known_id != catalogue.id()) {
    return absl::OutOfRangeError(
        absl::StrCat("the catalogue has the id ", catalogue.id(),
                     "; it is another one, or was restored: read all records anew"));
  }
  if (revision > catalogue.revision()) {
    return absl::OutOfRangeError(
        absl::StrCat("the catalogue is at revision ", catalogue.revision(), ", before ", revision,
                     "; it is another one, or was restored: read all records anew"));
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status ChangeService::SendChanges(bool include_records, std::int64_t* revision,
                                        Writer& writer) const {
  ASSIGN_OR_RETURN(const auto changes, catalogue_.ReadChanges(*revision, kChangesAtOnce));
  const std::string id = catalogue_.id();
  for (const storage::ChangeRecord& change : changes) {
    for (const v1::WatchCatalogResponse& response : ResponsesTo(change, id, include_records)) {
      if (!writer.Write(response)) return absl::CancelledError("the watcher is gone");
    }
    *revision = change.revision();
  }
  return absl::OkStatus();
}

absl::Status ChangeService::Watch(const grpc::ServerContext& context,
                                  const v1::WatchCatalogRequest& request, Writer& writer) const {
  ASSIGN_OR_RETURN(const auto heartbeat, HeartbeatOf(request));
  std::int64_t revision =
      request.has_after_revision() ? request.after_revision() : catalogue_.revision();
  RETURN_IF_ERROR(CheckBegin(catalogue_, request.catalog_id(), revision));
  // The first one at once: the caller then knows that it watches.
  Clock::time_point next_heartbeat = Clock::now();
  while (!IsAbandoned(context)) {
    if (stopping_) {
      return TryAgainLater(absl::UnavailableError(
          absl::StrCat("the server shuts down; watch again after revision ", revision)));
    }
    if (revision < catalogue_.revision()) {
      RETURN_IF_ERROR(SendChanges(request.include_records(), &revision, writer));
      continue;
    }
    const Clock::time_point now = Clock::now();
    if (now >= next_heartbeat) {
      v1::WatchCatalogResponse alive;
      alive.set_catalog_id(catalogue_.id());
      alive.set_catalog_revision(revision);
      if (!writer.Write(alive)) break;
      next_heartbeat = now + heartbeat;
    }
    live_.AwaitRevisionAfter(revision,
                             std::min<Clock::duration>(next_heartbeat - now, kCancelNoticed));
  }
  return absl::CancelledError("the watcher is gone");
}

grpc::Status ChangeService::WatchCatalog(grpc::ServerContext* context,
                                         const v1::WatchCatalogRequest* request, Writer* writer) {
  return Handle(*context, "WatchCatalog", *request, [&] {
    const CountedWatcher watcher(watchers_);
    if (watcher.others() < max_watchers_) return Watch(*context, *request, *writer);
    return TryAgainLater(absl::ResourceExhaustedError(
        absl::StrCat(max_watchers_, " watchers are connected already; end one first")));
  });
}

}  // namespace graspdb::server
