#include "storage/history/object_restorer.h"

#include <algorithm>

#include "base/status_macros.h"
#include "storage/changes/grasp_outcomes.h"
#include "storage/changes/history_rows.h"
#include "storage/changes/resource_writer.h"
#include "storage/records/record_kind.h"

namespace graspdb::storage {
namespace {

std::optional<Family> FamilyNamed(std::string_view name) {
  const auto* const found = std::ranges::find(kFamilyNames, name);
  if (found == kFamilyNames.end()) return std::nullopt;
  return static_cast<Family>(found - kFamilyNames.begin());
}

}  // namespace

absl::Status ObjectRestorer::Restore(std::string_view name, std::int64_t revision) {
  RETURN_IF_ERROR(ReadEarlier(name, revision));
  const auto own = earlier_.find({Family::kObjects, std::string(name)});
  ASSIGN_OR_RETURN(const auto exists, database_.Contains(Family::kObjects, name));
  if (own == earlier_.end() ? !exists : !own->second.value) {
    return absl::NotFoundError("there was no object " + std::string(name) + " at revision " +
                               std::to_string(revision) + "; list its revisions");
  }
  for (const auto& [key, earlier] : earlier_) {
    RETURN_IF_ERROR(Apply(key, earlier));
  }
  return absl::OkStatus();
}

// The rows are the newest first, so that the oldest one of a record is the last.
absl::Status ObjectRestorer::ReadEarlier(std::string_view name, std::int64_t revision) {
  return database_.Scan(Family::kHistory, HistoryPrefix(name), "",
                        [&](std::string_view key, std::string_view bytes) -> absl::StatusOr<bool> {
                          ASSIGN_OR_RETURN(auto row, ParseRow(key, bytes));
                          if (row.revision() <= revision) return false;
                          for (PreviousRecord& previous : *row.mutable_previous()) {
                            const auto family = FamilyNamed(previous.column_family());
                            if (!family) return DamagedRecord(ObjectOf(key));
                            Earlier& earlier = earlier_[{*family, previous.key()}];
                            earlier.revision = row.revision();
                            earlier.value.reset();
                            if (previous.has_value())
                              earlier.value = std::move(*previous.mutable_value());
                          }
                          return true;
                        });
}

absl::Status ObjectRestorer::Apply(const Key& key, const Earlier& earlier) {
  switch (key.first) {
    case Family::kObjects:
      return ApplyResource<v1::Object>(key.second, earlier);
    case Family::kStablePoses:
      return ApplyResource<v1::StablePose>(key.second, earlier);
    case Family::kViews:
      return ApplyView(key.second, earlier);
    default:
      return ApplyOutcomes(key.second, earlier);
  }
}

template <typename Record>
absl::Status ObjectRestorer::ApplyResource(const std::string& name, const Earlier& earlier) {
  constexpr Family kFamily = Kind<Record>::kFamily;
  constexpr bool kIsPose = kFamily == Family::kStablePoses;
  const auto now = ReadRecord<Record>(database_, name);
  if (!now.ok() && !absl::IsNotFound(now.status())) return now.status();
  if (!earlier.value) {
    if (!now.ok()) return absl::OkStatus();
    Begin();
    batch_.Remove(kFamily, name, now->SerializeAsString());
    return kIsPose ? RemoveGraspOutcomes(database_, batch_, name) : absl::OkStatus();
  }
  ASSIGN_OR_RETURN(auto then, ParseRecord<Record>(name, *earlier.value));
  std::vector<std::string> fields;
  if (now.ok()) fields = ChangedFields(*now, then);
  if (now.ok() && fields.empty()) return absl::OkStatus();
  Begin();
  then.set_etag(MakeEtag(batch_.meta().revision()));
  *then.mutable_update_time() = batch_.time();
  if (!now.ok()) {
    batch_.Insert(kFamily, name, then.SerializeAsString());
    return absl::OkStatus();
  }
  batch_.Replace(kFamily, name, now->SerializeAsString(), then.SerializeAsString(), fields);
  if constexpr (kIsPose) return ForgetChangedGrasps(database_, batch_, *now, then);
  return absl::OkStatus();
}

absl::Status ObjectRestorer::ApplyView(const std::string& name, const Earlier& earlier) {
  const auto now = ReadRecord<ViewRecord>(database_, name);
  if (!now.ok() && !absl::IsNotFound(now.status())) return now.status();
  if (!earlier.value) {
    if (!now.ok()) return absl::OkStatus();
    Begin();
    batch_.Remove(Family::kViews, name, now->SerializeAsString());
    batch_.NoteRemovedCloud(CloudKeyOf(*now));
    return absl::OkStatus();
  }
  ASSIGN_OR_RETURN(const auto then, ParseRecord<ViewRecord>(name, *earlier.value));
  // Descriptors may have been computed again since; content does not change.
  if (now.ok() && CloudKeyOf(*now) == CloudKeyOf(then)) return absl::OkStatus();
  Begin();
  if (now.ok()) {
    batch_.NoteRemovedCloud(CloudKeyOf(*now));
    batch_.Replace(Family::kViews, name, now->SerializeAsString(), *earlier.value);
  } else {
    batch_.Insert(Family::kViews, name, *earlier.value);
  }
  batch_.NoteStoredCloud(CloudKeyOf(then));
  return absl::OkStatus();
}

// Outcomes are in the history where they were removed: they come back with a stable pose that is
// not there now and had them when it changed next.
absl::Status ObjectRestorer::ApplyOutcomes(const std::string& name, const Earlier& earlier) {
  const auto pose = earlier_.find({Family::kStablePoses, name});
  if (!earlier.value || pose == earlier_.end() || !pose->second.value) return absl::OkStatus();
  ASSIGN_OR_RETURN(const auto exists, database_.Contains(Family::kStablePoses, name));
  if (exists || pose->second.revision != earlier.revision) return absl::OkStatus();
  Begin();
  batch_.Overwrite(Family::kGraspOutcomes, name, *earlier.value);
  return absl::OkStatus();
}

void ObjectRestorer::Begin() {
  if (batch_.changes().empty()) batch_.Begin();
}

}  // namespace graspdb::storage
