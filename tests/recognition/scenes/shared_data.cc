#include "tests/recognition/scenes/shared_data.h"

#include <cstdlib>

namespace graspdb::testing {
namespace {

std::filesystem::path Root() {
  const char* given = std::getenv("GRASPDB_SHARED_DATA");
  return given != nullptr ? given : GRASPDB_SHARED_DATA_DIR;
}

}  // namespace

std::optional<std::filesystem::path> SharedData(const std::string& folder) {
  std::filesystem::path path = Root() / folder;
  if (!std::filesystem::is_directory(path)) return std::nullopt;
  return path;
}

std::string SharedDataMissing(const std::string& folder) {
  return "the real data are missing: no folder " + (Root() / folder).string() +
         "; set GRASPDB_SHARED_DATA to where they are";
}

}  // namespace graspdb::testing
