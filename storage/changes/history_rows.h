// Rows of the family `history`: what a change did to an object, with the values before it. Internal
// to storage/.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "google/protobuf/message.h"
#include "rocksdb/write_batch.h"
#include "storage/changes/change_author.h"
#include "storage/database/database.h"
#include "storage/records.pb.h"

namespace graspdb::storage {

// Key of the row with the horizon. It precedes the rows of all objects.
inline constexpr std::string_view kHorizonKey = "horizon";

// Keys are `{object}/`, the complement of the revision and the number of the part, both big-endian:
// the newest change of an object is the first.
std::string HistoryPrefix(std::string_view object_name);
std::string HistoryKey(std::string_view object_name, std::int64_t revision, std::uint32_t part);
// The object in the key of a record, or of a row other than kHorizonKey.
std::string_view ObjectOf(std::string_view key);

// The row of that key; DATA_LOSS if it is damaged.
absl::StatusOr<HistoryRecord> ParseRow(std::string_view key, std::string_view bytes);

// Names of the fields that differ, without etag and update time.
std::vector<std::string> ChangedFields(const google::protobuf::Message& before,
                                       const google::protobuf::Message& after);

// Adds the rows of the changes of one batch to `rocks`. Both must outlive this.
class HistoryRows {
 public:
  HistoryRows(const Database& database, rocksdb::WriteBatch& rocks)
      : database_(database), rocks_(rocks), author_(ChangeAuthor::Current()) {}

  // A record before `change`. Only objects, stable poses, views, and outcomes that are removed are
  // kept; others are left out.
  void Add(const ChangeRecord& change, Family family, std::string_view key,
           PreviousRecord previous);
  // The first error, if any.
  absl::Status Finish();

 private:
  // Of one object in one change. The first row waits for the number of records.
  struct Rows {
    HistoryRecord first;
    HistoryRecord open;  // the last one, if it is not the first
    std::size_t bytes = 0;
    std::uint32_t parts = 1;
  };

  const Database& database_;
  rocksdb::WriteBatch& rocks_;
  const ChangeAuthor::Author author_;
  std::map<std::pair<std::int64_t, std::string>, Rows> rows_;
  absl::Status status_;
};

}  // namespace graspdb::storage
