// Text of unknown origin and length, made fit to be sent back.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace graspdb::server {

// `text` as valid UTF-8 of at most `most_bytes` (at least 3): what is no UTF-8 becomes '?', and
// what is too long is cut between two characters and ends in "...". Reads no more than `most_bytes`
// and one character of it.
std::string BoundedText(std::string_view text, std::size_t most_bytes);

}  // namespace graspdb::server
