// Writes that were done once and may be sent again: the ids of their requests, with the answers.
// Internal to storage/.
//
// A record is written in the batch of its effect, so that neither exists without the other. Records
// lie beside the MetaRecord and are no part of the catalogue: they have no change records, and a
// backup has them.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "storage/database/database.h"
#include "storage/records.pb.h"

namespace graspdb::storage {

// Ids that are kept, at most, some 200 bytes each: 2 MB. Callers repeat a call within seconds or
// minutes; ten cells with a pick every ten seconds each reach the number in three hours.
inline constexpr std::uint64_t kKeptRequests = 10'000;
// How long an id is known, at most. A program that was down over night still repeats its last call
// safely.
inline constexpr absl::Duration kKeptRequestTime = absl::Hours(24);

// The record of the request with this id. None if there was no such request or it is forgotten;
// ALREADY_EXISTS if its content was another.
absl::StatusOr<std::optional<RequestRecord>> FindRequest(const Database& database,
                                                         std::string_view id,
                                                         std::string_view content_digest,
                                                         const google::protobuf::Timestamp& now);

// Adds a record to the batch, with number and time, and deletes up to two that need not be kept any
// longer; counts in `meta`.
absl::Status KeepRequest(const Database& database, RequestRecord record,
                         const google::protobuf::Timestamp& now, MetaRecord& meta,
                         rocksdb::WriteBatch& batch);

}  // namespace graspdb::storage
