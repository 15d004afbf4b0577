// Rounding down.
#pragma once

#include <cstdint>

namespace graspdb::recognition {

// The value of std::floor for numbers of less than 2^63. Without a call: the instruction for it is
// newer (SSE 4.1) than the processors that programs are built for.
inline std::int64_t RoundDown(double number) {
  const auto whole = static_cast<std::int64_t>(number);
  return whole - (static_cast<double>(whole) > number ? 1 : 0);
}

}  // namespace graspdb::recognition
