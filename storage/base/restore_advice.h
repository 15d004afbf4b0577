// The end of every error that only a backup repairs.
#pragma once

#include <string_view>

namespace graspdb::storage {

inline constexpr std::string_view kRestoreAdvice =
    "restore a backup into an empty folder: graspdb backup restore --from BACKUPS --to FOLDER";

}  // namespace graspdb::storage
