// A file beside RocksDB's own with the minimum revision of the database.
//
// RocksDB treats a log or a manifest that lost its end as truncated by a crash, and
// silently opens an older state; files that the manifest no longer lists are deleted.
// The floor is written when the database is opened and closed, and periodically in
// between. A database that opens below it has lost acknowledged changes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace graspdb::storage {

// Name of the file in the database's directory.
inline constexpr std::string_view kRevisionFloorFile = "REVISION";

// Replaces the floor atomically and durably. UNAVAILABLE when the disk fails; the old
// floor, which is valid too, stays then.
absl::Status WriteRevisionFloor(const std::string& directory, std::int64_t revision);

// The floor; nullopt when there is none, as in a new or a restored database. DATA_LOSS
// when the file is invalid, UNAVAILABLE when it cannot be read.
absl::StatusOr<std::optional<std::int64_t>> ReadRevisionFloor(const std::string& directory);

}  // namespace graspdb::storage
