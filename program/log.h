// Logging of all programs: one line per event on stderr, `key=value` pairs (logfmt).
#pragma once

#include <string>

namespace graspdb {

// To be called once, before threads are started. `level`: debug, info, warn, error or off. gRPC's
// own messages are debug: they are verbose, and ours suggest what to do.
void StartLog(const std::string& program, const std::string& level);

}  // namespace graspdb
