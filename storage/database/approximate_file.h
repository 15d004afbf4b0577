// The file beside the database with its approximate index. Optional.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "storage/records.pb.h"

namespace graspdb::storage {

// Name of the file in the database's directory.
inline constexpr std::string_view kApproximateFile = "INDEX.flann";

// Replaces the file. UNAVAILABLE when the disk fails; the old file stays then.
absl::Status WriteApproximateFile(const std::string& directory,
                                  const ApproximateIndexRecord& record);

// NOT_FOUND when there is no file; UNAVAILABLE when it cannot be read; DATA_LOSS for any bytes that
// WriteApproximateFile did not write: a CRC-32C is checked before parsing.
absl::StatusOr<ApproximateIndexRecord> ReadApproximateFile(const std::string& directory);

}  // namespace graspdb::storage
