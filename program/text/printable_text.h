// UTF-8 text of unknown origin for terminals.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace graspdb {

// Bytes of the UTF-8 character at the start of `text` (RFC 3629), which is not empty; 0 if it is
// invalid.
std::size_t LengthOfCharacter(std::string_view text);

// `text` without what changes a terminal or the order of the text around it: control characters
// (C0, DEL, C1), overrides and isolates of the direction of writing, and bytes of invalid UTF-8
// become '?'. Other characters stay.
std::string PrintableText(std::string_view text);

}  // namespace graspdb
