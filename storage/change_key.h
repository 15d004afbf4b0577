// Keys of the family `changes`: the revision, big-endian, so that RocksDB's order of
// bytes is the order of revisions.
#pragma once

#include <cstdint>
#include <string>

namespace graspdb::storage {

inline std::string ChangeKey(std::int64_t revision) {
  std::string key(sizeof(revision), '\0');
  auto rest = static_cast<std::uint64_t>(revision);
  for (std::size_t i = key.size(); i-- > 0; rest >>= 8) key[i] = static_cast<char>(rest & 0xff);
  return key;
}

}  // namespace graspdb::storage
