// Builds one atomic write: records, their change records, and the new MetaRecord.
// Internal to storage/.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "rocksdb/write_batch.h"
#include "storage/changes/history_rows.h"
#include "storage/database/database.h"
#include "storage/records.pb.h"

namespace graspdb::storage {

// Used by one thread, inside ChangeLog::Mutate().
class ChangeBatch {
 public:
  // `database` must outlive the batch. `meta` is the MetaRecord before it.
  ChangeBatch(const Database& database, MetaRecord meta, google::protobuf::Timestamp time)
      : database_(database),
        meta_(std::move(meta)),
        time_(std::move(time)),
        history_(database, rocks_) {}

  // Begins the next change and returns its revision. Later calls belong to it.
  std::int64_t Begin();
  // Adds a new key: counted.
  void Insert(Family family, std::string_view key, std::string_view value);
  // Replaces the value of an existing key, of which `fields` changed, if known.
  void Replace(Family family, std::string_view key, std::string_view previous,
               std::string_view value, std::vector<std::string> fields = {});
  // The same for a value that the history does not keep: descriptors and counts.
  void Overwrite(Family family, std::string_view key, std::string_view value);
  // Removes an existing key: no longer counted.
  void Remove(Family family, std::string_view key, std::string_view previous);
  // Notes in the change record that a view has a cloud which is stored already, or has no longer
  // the cloud of this key. The cloud stays as long as the history has the view
  // (storage/history/history.h).
  void NoteStoredCloud(std::string_view key) { Note(Mutation::KIND_PUT, Family::kClouds, key); }
  void NoteRemovedCloud(std::string_view key) { Note(Mutation::KIND_DELETE, Family::kClouds, key); }
  // Keeps an answered request, whose number and time are set here, and forgets old ones
  // (storage/changes/requests.h).
  void KeepRequest(RequestRecord record);
  // Adds the change records, the deletion of old ones so that `keep` (at least 1) remain, and the
  // MetaRecord. After it only rocks() may be called. Returns the first error of the previous calls,
  // if any.
  absl::Status Finish(std::int64_t keep);

  const google::protobuf::Timestamp& time() const { return time_; }
  // The MetaRecord after it.
  const MetaRecord& meta() const { return meta_; }
  const std::vector<ChangeRecord>& changes() const { return changes_; }
  rocksdb::WriteBatch& rocks() { return rocks_; }

 private:
  void ForgetChanges(std::int64_t keep);
  void Note(Mutation::Kind kind, Family family, std::string_view key);

  const Database& database_;
  MetaRecord meta_;
  google::protobuf::Timestamp time_;
  std::vector<ChangeRecord> changes_;
  rocksdb::WriteBatch rocks_;
  HistoryRows history_;
  absl::Status status_;
};

}  // namespace graspdb::storage
