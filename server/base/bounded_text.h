// Sanitises text of unknown origin and length for responses.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace graspdb::server {

// `text` as valid UTF-8 of at most `max_bytes` (at least 3): invalid UTF-8 becomes '?', and longer
// text is cut between two characters and ends in "...". Reads no more than `max_bytes` and one
// character of it.
std::string BoundedText(std::string_view text, std::size_t max_bytes);

}  // namespace graspdb::server
