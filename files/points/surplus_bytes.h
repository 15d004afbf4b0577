// Bytes behind the body of a binary file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace graspdb::files {

// Why the bytes behind a binary body show that the file at `path` is damaged; empty without such
// bytes. The body begins at byte `body_offset`, and its header promises `promised` bytes.
//
// Zeros are no damage where they are fewer than a page of memory: earlier versions of PCL write as
// many.
std::string SurplusError(const std::filesystem::path& path, std::uint64_t body_offset,
                         std::uint64_t promised);

}  // namespace graspdb::files
