#include "server/base/bounded_text.h"

#include "program/text/printable_text.h"

namespace graspdb::server {
namespace {

constexpr std::string_view kCut = "...";

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
