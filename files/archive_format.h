// The bytes of archives, for writer and reader; docs/storage-format.md describes them.
#pragma once

#include <cstddef>
#include <string_view>

namespace graspdb::files {

// The last byte is the version of the format.
inline constexpr std::string_view kArchiveMagic{"GAR\x01", 4};

// Before each record, little-endian: bytes of its zstd frame, and the CRC-32C of these four bytes
// and of the frame.
inline constexpr std::size_t kArchiveFrameHeaderBytes = 8;
inline constexpr std::size_t kArchiveLengthBytes = 4;

}  // namespace graspdb::files
