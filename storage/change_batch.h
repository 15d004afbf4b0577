// One atomic write in the making: records, the change records that tell of them, and
// the new MetaRecord. Internal to storage/.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "rocksdb/write_batch.h"
#include "storage/database.h"
#include "storage/records.pb.h"

namespace graspdb::storage {

// Used by one thread, inside ChangeLog::Mutate().
class ChangeBatch {
 public:
  // `database` must outlive the batch. `meta` is where the catalogue stands before it.
  ChangeBatch(const Database& database, MetaRecord meta, google::protobuf::Timestamp time)
      : database_(database), meta_(std::move(meta)), time_(std::move(time)) {}

  // Begins the next change and returns its revision. What follows belongs to it.
  std::int64_t Begin();
  // A key that is not there yet: counted.
  void Insert(Family family, std::string_view key, std::string_view value);
  // A key that is there.
  void Overwrite(Family family, std::string_view key, std::string_view value);
  // A key that is there: no longer counted.
  void Remove(Family family, std::string_view key);
  // Adds the change records, the deletion of old ones so that `keep` (at least 1) stay, and the
  // MetaRecord. After it only rocks() is of use. The first error of anything before, if there was
  // one.
  absl::Status Finish(std::int64_t keep);

  const google::protobuf::Timestamp& time() const { return time_; }
  // Where the catalogue stands after it.
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
  absl::Status status_;
};

}  // namespace graspdb::storage
