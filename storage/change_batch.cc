#include "storage/change_batch.h"

#include <string>

#include "storage/change_key.h"
#include "storage/schema.h"

namespace graspdb::storage {
namespace {

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
}

void ChangeBatch::Overwrite(Family family, std::string_view key, std::string_view value) {
  status_.Update(database_.Put(family, key, value, rocks_));
  Note(Mutation::KIND_PUT, family, key);
  if (family == Family::kClouds) return;  // never changes, so its key says it all
  ChangeRecord& change = changes_.back();
  change.mutable_mutations(change.mutations_size() - 1)->set_value(std::string(value));
}

void ChangeBatch::Remove(Family family, std::string_view key) {
  status_.Update(database_.Delete(family, key, rocks_));
  Note(Mutation::KIND_DELETE, family, key);
  AddToCount(meta_, family, -1);
}

absl::Status ChangeBatch::Finish() {
  for (const ChangeRecord& change : changes_) {
    status_.Update(database_.Put(Family::kChanges, ChangeKey(change.revision()),
                                 change.SerializeAsString(), rocks_));
  }
  status_.Update(database_.Put(Family::kMeta, kMetaKey, meta_.SerializeAsString(), rocks_));
  return status_;
}

}  // namespace graspdb::storage
