#include "server/live/approximate_index_builder.h"

#include <spdlog/spdlog.h>

#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "absl/time/clock.h"
#include "base/status_macros.h"
#include "program/log/log_field.h"
#include "recognition/index/recall.h"
#include "storage/database/approximate_file.h"

namespace graspdb::server {
namespace {

using recognition::ApproximateIndex;
using recognition::DescriptorIndex;

// The index is rebuilt once more than a fifth of its views were added or deleted since. Among
// 10,000 views an exact search of a fifth takes as long as one in the index.
constexpr std::size_t kShareOutdated = 5;

bool IsOutdated(const DescriptorIndex& index, std::size_t tried) {
  if (index.approximate() == nullptr) {
    return index.view_count() >= ApproximateIndex::kMaxNeighbors &&
           index.view_count() > tried + tried / kShareOutdated;
  }
  return kShareOutdated * (index.newer_view_count() + index.deleted_view_count()) >
         index.approximate()->places().size();
}

// Places of the descriptors of the file's views; null for views that were deleted.
std::vector<ApproximateIndex::Place> PlacesOf(const storage::ApproximateIndexRecord& record,
                                              const DescriptorIndex& index) {
  std::unordered_map<std::string, std::size_t> numbers;
  for (int i = 0; i < record.names_size(); ++i) {
    numbers.emplace(record.names(i), static_cast<std::size_t>(i));
  }
  std::vector<ApproximateIndex::Place> out(static_cast<std::size_t>(record.names_size()));
  for (const auto& chunk : index.chunks()) {
    for (std::size_t row = 0; row < chunk->size(); ++row) {
      const recognition::TaughtView& view = *chunk->views()[row];
      const auto found = numbers.find(view.name);
      if (found == numbers.end()) continue;
      if (record.content_digests(static_cast<int>(found->second)) != view.content) continue;
      out[found->second] = {chunk.get(), row};
    }
  }
  return out;
}

}  // namespace

ApproximateIndexBuilder::ApproximateIndexBuilder(
    const storage::Catalogue& catalogue, LiveCatalogue& live,
    const recognition::DescriptorParameters& parameters)
    : catalogue_(catalogue), live_(live), parameters_(parameters) {
  if (const absl::Status loaded = Load(); !loaded.ok()) {
    spdlog::info("event=approximate_index_rebuild reason={}",
                 LogField(std::string(loaded.message())));
  }
  RebuildIfOutdated();
}

absl::Status ApproximateIndexBuilder::Load() {
  ASSIGN_OR_RETURN(storage::ApproximateIndexRecord record,
                   storage::ReadApproximateFile(catalogue_.directory()));
  if (record.parameters() != parameters_.Fingerprint() ||
      record.content_digests_size() != record.names_size()) {
    return absl::FailedPreconditionError("it was built with other parameters");
  }
  const auto snapshot = live_.snapshot();
  const auto chunks = snapshot->index.chunks();
  ApproximateIndex::Saved saved;
  saved.library = record.library();
  saved.projection.means.assign(record.means().begin(), record.means().end());
  saved.projection.axes.assign(record.axes().begin(), record.axes().end());
  saved.tree = std::move(*record.mutable_tree());
  saved.view_count = static_cast<std::size_t>(record.names_size());
  saved.search = {record.checks(), record.candidates()};
  saved.recall_at_10 = record.recall_at_10();
  ASSIGN_OR_RETURN(auto loaded, ApproximateIndex::Load(saved, PlacesOf(record, snapshot->index),
                                                       {chunks.begin(), chunks.end()}));
  live_.UseApproximate(loaded);
  on_file_ = true;
  return absl::OkStatus();
}

absl::Status ApproximateIndexBuilder::Write(const ApproximateIndex& index) {
  ASSIGN_OR_RETURN(ApproximateIndex::Saved saved, index.Save());
  storage::ApproximateIndexRecord record;
  record.set_library(saved.library);
  record.set_parameters(parameters_.Fingerprint());
  for (const ApproximateIndex::Place& place : index.places()) {
    const recognition::TaughtView& view = *place.chunk->views()[place.row];
    record.add_names(view.name);
    record.add_content_digests(view.content);
  }
  const recognition::RootProjection::Numbers& projection = saved.projection;
  record.mutable_means()->Add(projection.means.begin(), projection.means.end());
  record.mutable_axes()->Add(projection.axes.begin(), projection.axes.end());
  record.set_tree(std::move(saved.tree));
  record.set_checks(saved.search.checks);
  record.set_candidates(saved.search.candidates);
  record.set_recall_at_10(saved.recall_at_10);
  return storage::WriteApproximateFile(catalogue_.directory(), record);
}

void ApproximateIndexBuilder::RebuildIfOutdated() {
  // A reload of all records gives a snapshot without one.
  if (on_file_ && live_.snapshot()->index.approximate() == nullptr) on_file_ = Load().ok();
  if (IsOutdated(live_.snapshot()->index, tried_)) Rebuild();
}

void ApproximateIndexBuilder::Rebuild() {
  const absl::Time begin = absl::Now();
  const auto snapshot = live_.snapshot();
  tried_ = snapshot->index.view_count();
  const auto made = recognition::WithNewApproximate(snapshot->index);
  if (!made.ok()) {
    spdlog::warn("event=approximate_index_not_made error={}",
                 LogField(std::string(made.status().message())));
    live_.UseApproximate(nullptr);
    on_file_ = false;
    return;
  }
  const auto& index = made->approximate();
  const absl::Status written = Write(*index);
  on_file_ = written.ok();
  if (!on_file_) {
    spdlog::warn("event=approximate_index_not_written error={}",
                 LogField(std::string(written.message())));
  }
  live_.UseApproximate(index);
  spdlog::info("event=approximate_index_made views={} checks={} recall_at_10={:.4f} ms={}",
               index->places().size(), index->search().checks, index->recall_at_10(),
               absl::ToInt64Milliseconds(absl::Now() - begin));
}

}  // namespace graspdb::server
