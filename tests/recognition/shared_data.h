// Where the real data lie that some tests need.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace graspdb::testing {

// The folder of that name in $GRASPDB_SHARED_DATA or, without it, where the build
// was told; nullopt when it is missing: then the test skips.
std::optional<std::filesystem::path> SharedData(const std::string& folder);

// What a test that skips says.
std::string SharedDataMissing(const std::string& folder);

}  // namespace graspdb::testing
