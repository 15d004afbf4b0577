// A file beside RocksDB's own that says which revision the database has at least.
//
// RocksDB takes a log or a manifest that lost its end for one that a crash cut off, and
// opens an older state without a word; whatever the manifest no longer names is deleted.
// The floor is written when the database is opened and closed, and now and then
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
// floor, which is as true as the new one, stays then.
absl::Status WriteRevisionFloor(const std::string& directory, std::int64_t revision);

// The floor; nothing when there is none, as in a new or a restored database. DATA_LOSS
// when the file cannot be understood.
absl::StatusOr<std::optional<std::int64_t>> ReadRevisionFloor(const std::string& directory);

}  // namespace graspdb::storage
