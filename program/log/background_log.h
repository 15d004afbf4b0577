// A log that no call waits for.
#pragma once

#include <cstdint>
#include <string>

namespace graspdb {

// As StartLog(), but a thread of its own writes the lines. While the reader of standard error does
// not read, some thousand lines wait, and then the oldest ones are lost: their number is logged
// once the reader goes on. The program's end waits for the lines, but no longer than a second.
void StartBackgroundLog(const std::string& program, const std::string& level);

// Lines that were lost since the start; 0 without a background log.
std::int64_t LostLogLines();

}  // namespace graspdb
