#include "program/text/printable_text.h"

#include <algorithm>
#include <cstdint>

namespace graspdb {
namespace {

bool IsBetween(char c, unsigned lo, unsigned hi) {
  const auto byte = static_cast<unsigned char>(c);
  return byte >= lo && byte <= hi;
}

// The code point of one valid character.
std::uint32_t CodePointOf(std::string_view character) {
  const auto first = static_cast<unsigned char>(character.front());
  std::uint32_t out = character.size() == 1 ? first : first & (0x7fU >> character.size());
  for (const char c : character.substr(1)) {
    out = (out << 6U) | (static_cast<unsigned char>(c) & 0x3fU);
  }
  return out;
}

bool IsPrintable(std::uint32_t code_point) {
  const bool is_control = code_point < 0x20 || (code_point >= 0x7f && code_point <= 0x9f);
  const bool is_direction = (code_point >= 0x202a && code_point <= 0x202e) ||
                            (code_point >= 0x2066 && code_point <= 0x2069);
  return !is_control && !is_direction;
}

}  // namespace

std::size_t LengthOfCharacter(std::string_view text) {
  const auto first = static_cast<unsigned char>(text.front());
  if (first < 0x80) return 1;
  if (first < 0xc2 || first > 0xf4) return 0;
  const std::size_t length = first < 0xe0 ? 2 : first < 0xf0 ? 3 : 4;
  if (text.size() < length) return 0;
  // No overlong forms, no surrogates, nothing beyond U+10FFFF.
  const unsigned lowest = first == 0xe0 ? 0xa0 : first == 0xf0 ? 0x90 : 0x80;
  const unsigned highest = first == 0xed ? 0x9f : first == 0xf4 ? 0x8f : 0xbf;
  if (!IsBetween(text[1], lowest, highest)) return 0;
  for (std::size_t i = 2; i < length; ++i) {
    if (!IsBetween(text[i], 0x80, 0xbf)) return 0;
  }
  return length;
}

std::string PrintableText(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const std::size_t length = LengthOfCharacter(text);
    const std::string_view character = text.substr(0, std::max<std::size_t>(length, 1));
    if (length > 0 && IsPrintable(CodePointOf(character))) {
      out += character;
    } else {
      out += '?';
    }
    text.remove_prefix(character.size());
  }
  return out;
}

}  // namespace graspdb
