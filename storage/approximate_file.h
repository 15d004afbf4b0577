// The file beside the database that holds its approximate index. Nothing depends on it.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "storage/records.pb.h"

namespace graspdb::storage {

// Name of the file in the database's directory.
inline constexpr std::string_view kApproximateFile = "INDEX.flann";

// Puts the file in the place of the one before. UNAVAILABLE when the disk fails; the file before
// stays then.
absl::Status WriteApproximateFile(const std::string& directory,
                                  const ApproximateIndexRecord& record);

// NOT_FOUND when there is no file; DATA_LOSS for everything that WriteApproximateFile did not write
// so, whatever the bytes are: a CRC-32C is checked before anything is parsed.
absl::StatusOr<ApproximateIndexRecord> ReadApproximateFile(const std::string& directory);

}  // namespace graspdb::storage
