// Puts an object back to an earlier revision. Internal to storage/.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "absl/status/status.h"
#include "storage/changes/change_batch.h"
#include "storage/database/database.h"
#include "storage/records.pb.h"

namespace graspdb::storage {

// Used once, inside ChangeLog::Mutate().
class ObjectRestorer {
 public:
  // Both must outlive this.
  ObjectRestorer(const Database& database, ChangeBatch& batch)
      : database_(database), batch_(batch) {}

  // Adds a change to the batch that puts the object with its stable poses and views back to their
  // state after `revision`; none if they have it. All changes after it are in the history.
  // NOT_FOUND when there was no such object.
  absl::Status Restore(std::string_view name, std::int64_t revision);

 private:
  // A record after the revision.
  struct Earlier {
    std::optional<std::string> value;  // absent: there was none
    std::int64_t revision = 0;         // of the first change after it
  };
  using Key = std::pair<Family, std::string>;

  absl::Status ReadEarlier(std::string_view name, std::int64_t revision);
  absl::Status Apply(const Key& key, const Earlier& earlier);
  // For objects and stable poses.
  template <typename Record>
  absl::Status ApplyResource(const std::string& name, const Earlier& earlier);
  absl::Status ApplyView(const std::string& name, const Earlier& earlier);
  absl::Status ApplyOutcomes(const std::string& name, const Earlier& earlier);
  // Begins the change, once.
  void Begin();

  const Database& database_;
  ChangeBatch& batch_;
  std::map<Key, Earlier> earlier_;  // records that changed since; parents before children
};

}  // namespace graspdb::storage
