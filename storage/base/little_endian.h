// Numbers in files, the lowest byte first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace graspdb::storage {

inline constexpr std::size_t kUint32Bytes = 4;

inline std::string ToLittleEndian(std::uint32_t value) {
  std::string bytes;
  for (std::size_t i = 0; i < kUint32Bytes; ++i) {
    bytes += static_cast<char>((value >> (8 * i)) & 0xff);
  }
  return bytes;
}

// The value of at most four bytes.
inline std::uint32_t FromLittleEndian(std::string_view bytes) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    value |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i])) << (8 * i);
  }
  return value;
}

}  // namespace graspdb::storage
