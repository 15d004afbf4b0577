#include "storage/backups/difference.h"

#include <memory>

#include "base/status_macros.h"
#include "rocksdb/iterator.h"
#include "storage/database/rocksdb_status.h"

namespace graspdb::storage {
namespace {

// Null at the end, or where an older database has no such family.
std::unique_ptr<rocksdb::Iterator> RowsOf(const DatabaseState& state, Family family) {
  if (!state.database.HasFamily(family)) return nullptr;
  return state.database.Rows(family, state.snapshot);
}

absl::Status StatusOf(const rocksdb::Iterator* rows) {
  return rows == nullptr ? absl::OkStatus() : FromRocksDb(rows->status(), "compare the records");
}

// Merges the rows of both; each row is in one of the states or in both.
absl::Status CompareRows(rocksdb::Iterator* before, rocksdb::Iterator* after,
                         const BackupProgress& progress, DifferenceVisitor visit) {
  const auto at_row = [](const rocksdb::Iterator* rows) {
    return rows != nullptr && rows->Valid();
  };
  while (at_row(before) || at_row(after)) {
    if (progress.IsCancelled()) return absl::CancelledError("the comparison was cancelled");
    int order = at_row(before) ? -1 : 1;
    if (at_row(before) && at_row(after)) order = before->key().compare(after->key());
    Difference difference;
    difference.kind = order == 0  ? Difference::Kind::kChanged
                      : order < 0 ? Difference::Kind::kRemoved
                                  : Difference::Kind::kAdded;
    if (order != 0 || before->value() != after->value()) {
      difference.name = (order <= 0 ? before : after)->key().ToString();
      RETURN_IF_ERROR(visit(difference));
    }
    if (order <= 0) before->Next();
    if (order >= 0) after->Next();
  }
  absl::Status read = StatusOf(before);
  read.Update(StatusOf(after));
  return read;
}

}  // namespace

absl::Status FindDifferences(const DatabaseState& before, const DatabaseState& after,
                             const BackupProgress& progress, DifferenceVisitor visit) {
  for (const Family family :
       {Family::kObjects, Family::kStablePoses, Family::kViews, Family::kCells}) {
    const auto rows_before = RowsOf(before, family);
    const auto rows_after = RowsOf(after, family);
    RETURN_IF_ERROR(CompareRows(rows_before.get(), rows_after.get(), progress, visit));
  }
  return absl::OkStatus();
}

}  // namespace graspdb::storage
