// CRC-32C (Castagnoli, RFC 3720): the checksum of RocksDB's logs and of our packed clouds.
#pragma once

#include <cstdint>
#include <string_view>

namespace graspdb::storage {

// The checksum of `data` when the preceding data has the checksum `before` (0: no
// data). Crc32c(b, Crc32c(a)) is the checksum of a followed by b.
std::uint32_t Crc32c(std::string_view data, std::uint32_t before = 0);

}  // namespace graspdb::storage
