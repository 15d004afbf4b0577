// Location of the real data that some tests need.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace graspdb::testing {

// The folder of that name in $GRASPDB_SHARED_DATA or, without it, in the configured path; nullopt
// when it is missing: then the test skips.
std::optional<std::filesystem::path> SharedData(const std::string& folder);

// Message of a skipped test.
std::string SharedDataMissing(const std::string& folder);

}  // namespace graspdb::testing
