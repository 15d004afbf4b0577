#include "server/bounded_text.h"

namespace graspdb::server {
namespace {

constexpr std::string_view kCut = "...";

bool IsBetween(char c, unsigned lo, unsigned hi) {
  const auto byte = static_cast<unsigned char>(c);
  return byte >= lo && byte <= hi;
}

// Bytes of the character at the start of `text` (RFC 3629); 0 if it is invalid.
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

}  // namespace

std::string BoundedText(std::string_view text, std::size_t max_bytes) {
  std::string out;
  std::size_t cut_at = 0;  // where the mark of a cut still fits
  while (!text.empty()) {
    const std::size_t length = LengthOfCharacter(text);
    const std::string_view character = length == 0 ? "?" : text.substr(0, length);
    if (out.size() + character.size() > max_bytes) {
      out.resize(cut_at);
      out += kCut;
      return out;
    }
    out += character;
    if (out.size() + kCut.size() <= max_bytes) cut_at = out.size();
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return out;
}

}  // namespace graspdb::server
