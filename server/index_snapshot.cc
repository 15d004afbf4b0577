#include "server/index_snapshot.h"

#include <algorithm>
#include <string>
#include <unordered_set>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "server/change_effects.h"
#include "server/index_block.h"
#include "server/records.h"
#include "storage/family.h"
#include "storage/index_file.h"

namespace graspdb::server {
namespace {

using Names = std::unordered_set<std::string>;

constexpr std::size_t kChangesRead = 256;

absl::Status CheckMadeFrom(const storage::IndexHeader& header, const storage::Catalogue& catalogue,
                           const recognition::DescriptorParameters& parameters) {
  if (header.parameters() != parameters.Fingerprint()) {
    return absl::FailedPreconditionError(
        absl::StrCat("it was built with other parameters, ", header.parameters()));
  }
  const absl::StatusOr<std::string> mark = catalogue.MarkOf(header.revision());
  if (absl::IsNotFound(mark.status())) {
    return absl::FailedPreconditionError(
        "it was built from another database, or the changes since then are no longer kept");
  }
  if (!mark.ok()) return mark.status();
  if (*mark != header.mark()) {
    return absl::FailedPreconditionError("it was built from another database");
  }
  const std::int64_t behind = catalogue.revision() - header.revision();
  if (behind <= kMaxChangesBehind) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrCat("it is ", behind, " changes behind"));
}

// Views that were written or deleted after `revision`.
absl::StatusOr<Names> ChangedViews(const storage::Catalogue& catalogue, std::int64_t revision) {
  Names out;
  while (revision < catalogue.revision()) {
    const auto changes = catalogue.ReadChanges(revision, kChangesRead);
    if (!changes.ok()) return changes.status();
    if (changes->empty()) return absl::DataLossError("change records are missing");
    for (const storage::ChangeRecord& change : *changes) {
      for (const storage::Mutation& mutation : change.mutations()) {
        if (mutation.column_family() == storage::FamilyName(storage::Family::kViews)) {
          out.insert(mutation.key());
        }
      }
    }
    revision = changes->back().revision();
  }
  return out;
}

// The views of the file, except those that have changed.
absl::Status AddUnchanged(storage::IndexFileReader& file, const Names& changed, int size,
                          ViewCollector& collector) {
  std::int64_t count = 0;
  storage::IndexBlock block;
  for (std::int64_t i = 0; i < file.header().block_count(); ++i) {
    if (absl::Status status = file.Next(&block); !status.ok()) return status;
    auto views = ViewsFromBlock(block, size);
    if (!views.ok()) return views.status();
    count += std::ssize(*views);
    for (recognition::IndexedView& view : *views) {
      if (!changed.contains(view.view->name)) collector.Add(std::move(view));
    }
  }
  if (count != file.header().view_count()) {
    return absl::DataLossError("the number of views in the index file differs from its header");
  }
  return file.Finish();
}

// The current records of the changed views; deleted ones are left out.
absl::Status AddChanged(const storage::Catalogue& catalogue, const Names& changed,
                        const recognition::DescriptorParameters& parameters,
                        ViewCollector& collector, std::vector<std::string>& left_out) {
  for (const std::string& name : changed) {
    const absl::StatusOr<storage::ViewRecord> record = catalogue.GetView(name);
    if (absl::IsNotFound(record.status())) continue;
    if (!record.ok()) return record.status();
    auto view = IndexedViewFromRecord(*record, parameters);
    if (absl::IsDataLoss(view.status())) {
      LogLeftOut(name, view.status());
      left_out.push_back(name);
      continue;
    }
    if (!view.ok()) return view.status();
    collector.Add(*std::move(view));
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status WriteIndexSnapshot(const storage::Catalogue& catalogue,
                                const recognition::CatalogueSnapshot& snapshot,
                                const recognition::DescriptorParameters& parameters) {
  absl::StatusOr<std::string> mark = catalogue.MarkOf(snapshot.revision);
  if (!mark.ok()) return mark.status();
  storage::IndexHeader header;
  header.set_mark(*std::move(mark));
  header.set_revision(snapshot.revision);
  header.set_parameters(parameters.Fingerprint());
  header.set_view_count(static_cast<std::int64_t>(snapshot.index.view_count()));
  header.set_block_count(std::ssize(snapshot.index.chunks()));
  storage::IndexFileWriter file(catalogue.directory(), header);
  for (const auto& chunk : snapshot.index.chunks()) {
    if (absl::Status status = file.Append(BlockFromChunk(*chunk)); !status.ok()) return status;
  }
  return file.Commit();
}

absl::StatusOr<LoadedViews> ReadIndexSnapshot(const storage::Catalogue& catalogue,
                                              const recognition::DescriptorParameters& parameters) {
  auto file = storage::IndexFileReader::Open(catalogue.directory());
  if (!file.ok()) return file.status();
  absl::Status status = CheckMadeFrom(file->header(), catalogue, parameters);
  if (!status.ok()) return status;
  const auto changed = ChangedViews(catalogue, file->header().revision());
  if (!changed.ok()) return changed.status();
  const int size = recognition::DescriptorSize(parameters.kind);
  ViewCollector collector(size);
  status.Update(AddUnchanged(*file, *changed, size, collector));
  std::vector<std::string> left_out;
  if (status.ok()) status.Update(AddChanged(catalogue, *changed, parameters, collector, left_out));
  if (!status.ok()) return status;
  LoadedViews out = collector.Finish(catalogue.revision());
  out.left_out = std::move(left_out);
  // Views that were left out when the file was written are in neither, but in the records.
  if (std::ssize(out.views) + std::ssize(out.left_out) != catalogue.counts().views) {
    return absl::DataLossError("the views in the index file differ from those in the database");
  }
  out.file_revision = file->header().revision();
  return out;
}

}  // namespace graspdb::server
