#include "storage/changes/change_batch.h"

#include <algorithm>
#include <string>
#include <utility>

#include "storage/changes/requests.h"
#include "storage/changes/schema.h"
#include "storage/database/family.h"

namespace graspdb::storage {
namespace {

// Maximum number of change records that one write deletes, so that a database with millions of them
// takes some kilobytes more per write until they are deleted. Twice as many: twice that.
constexpr std::int64_t kMaxForgotten = 1024;

// Bytes of a change record beyond which it is stored without values: those of a large upload would
// be in the database twice.
constexpr std::size_t kMaxChangeBytes = 1U << 20;

std::string Stored(const ChangeRecord& change) {
  if (change.ByteSizeLong() <= kMaxChangeBytes) return change.SerializeAsString();
  ChangeRecord keys_only = change;
  for (Mutation& mutation : *keys_only.mutable_mutations()) mutation.clear_value();
  return keys_only.SerializeAsString();
}

void AddToCount(MetaRecord& meta, Family family, std::int64_t difference) {
  switch (family) {
    case Family::kObjects:
      return meta.set_object_count(meta.object_count() + difference);
    case Family::kStablePoses:
      return meta.set_stable_pose_count(meta.stable_pose_count() + difference);
    case Family::kViews:
      return meta.set_view_count(meta.view_count() + difference);
    case Family::kCells:
      return meta.set_cell_count(meta.cell_count() + difference);
    case Family::kMeta:
    case Family::kClouds:  // as many as views
    case Family::kChanges:
    case Family::kGraspOutcomes:
    case Family::kUploads:
    case Family::kStagedViews:
    case Family::kHistory:
    case Family::kDeletedObjects:
      return;
  }
}

}  // namespace

std::int64_t ChangeBatch::Begin() {
  meta_.set_revision(meta_.revision() + 1);
  ChangeRecord& change = changes_.emplace_back();
  change.set_revision(meta_.revision());
  *change.mutable_time() = time_;
  return change.revision();
}

void ChangeBatch::Note(Mutation::Kind kind, Family family, std::string_view key) {
  Mutation& mutation = *changes_.back().add_mutations();
  mutation.set_kind(kind);
  mutation.set_column_family(std::string(FamilyName(family)));
  mutation.set_key(std::string(key));
}

void ChangeBatch::Insert(Family family, std::string_view key, std::string_view value) {
  Overwrite(family, key, value);
  AddToCount(meta_, family, 1);
  PreviousRecord absent;
  history_.Add(changes_.back(), family, key, std::move(absent));
}

void ChangeBatch::Replace(Family family, std::string_view key, std::string_view previous,
                          std::string_view value, std::vector<std::string> fields) {
  Overwrite(family, key, value);
  PreviousRecord before;
  before.set_value(std::string(previous));
  before.mutable_fields()->Assign(fields.begin(), fields.end());
  history_.Add(changes_.back(), family, key, std::move(before));
}

void ChangeBatch::Overwrite(Family family, std::string_view key, std::string_view value) {
  status_.Update(database_.Put(family, key, value, rocks_));
  Note(Mutation::KIND_PUT, family, key);
  if (family == Family::kClouds) return;  // never changes, so its key is enough
  ChangeRecord& change = changes_.back();
  change.mutable_mutations(change.mutations_size() - 1)->set_value(std::string(value));
}

void ChangeBatch::Remove(Family family, std::string_view key, std::string_view previous) {
  status_.Update(database_.Delete(family, key, rocks_));
  Note(Mutation::KIND_DELETE, family, key);
  AddToCount(meta_, family, -1);
  PreviousRecord before;
  before.set_value(std::string(previous));
  before.set_removed(true);
  history_.Add(changes_.back(), family, key, std::move(before));
}

void ChangeBatch::KeepRequest(RequestRecord record) {
  status_.Update(storage::KeepRequest(database_, std::move(record), time_, meta_, rocks_));
}

void ChangeBatch::ForgetChanges(std::int64_t keep) {
  const std::int64_t horizon = meta_.change_horizon();
  const std::int64_t last = std::min(meta_.revision() - keep, horizon + kMaxForgotten);
  if (last <= horizon) return;
  for (std::int64_t revision = horizon + 1; revision <= last; ++revision) {
    status_.Update(database_.Delete(Family::kChanges, ChangeKey(revision), rocks_));
  }
  meta_.set_change_horizon(last);
}

absl::Status ChangeBatch::Finish(std::int64_t keep) {
  status_.Update(history_.Finish());
  for (const ChangeRecord& change : changes_) {
    status_.Update(
        database_.Put(Family::kChanges, ChangeKey(change.revision()), Stored(change), rocks_));
  }
  ForgetChanges(keep);  // after the puts: one batch may have more changes than are kept
  status_.Update(database_.Put(Family::kMeta, kMetaKey, meta_.SerializeAsString(), rocks_));
  return status_;
}

}  // namespace graspdb::storage
