// Random UUIDs (version 4). In a header, so that the client library needs no other of ours.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <string_view>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"

namespace graspdb {

// Whether `text` is one, in digits of either case: xxxxxxxx-xxxx-4xxx-[89ab]xxx-xxxxxxxxxxxx.
inline bool IsUuid4(std::string_view text) {
  constexpr std::string_view kPattern = "hhhhhhhh-hhhh-4hhh-vhhh-hhhhhhhhhhhh";
  const auto fits = [](char c, char wanted) {
    const bool is_digit = absl::ascii_isxdigit(static_cast<unsigned char>(c));
    if (wanted == 'h') return is_digit;
    if (wanted == 'v') return std::string_view("89abAB").find(c) != std::string_view::npos;
    return c == wanted;
  };
  return std::ranges::equal(text, kPattern, fits);
}

// A new one, from the system's random numbers. Takes a microsecond. Thread-safe.
inline std::string MakeUuid4() {
  std::random_device device;
  std::array<std::uint32_t, 4> words{};
  std::ranges::generate(words, std::ref(device));
  words[1] = (words[1] & 0xffff0fffU) | 0x4000U;      // version 4
  words[2] = (words[2] & 0x3fffffffU) | 0x80000000U;  // variant of RFC 4122
  const auto half = [](std::uint32_t bits) { return absl::Hex(bits & 0xffffU, absl::kZeroPad4); };
  const auto whole = [](std::uint32_t bits) { return absl::Hex(bits, absl::kZeroPad8); };
  return absl::StrCat(whole(words[0]), "-", half(words[1] >> 16U), "-", half(words[1]), "-",
                      half(words[2] >> 16U), "-", half(words[2]), whole(words[3]));
}

}  // namespace graspdb
