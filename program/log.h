// How every program logs: one line an event on stderr, `key=value` pairs (logfmt).
#pragma once

#include <string>

namespace graspdb {

// Once, before threads are started. `level`: debug, info, warn, error or off. gRPC's own messages
// are debug: they are a mouthful on top of ours, which say what to do.
void StartLog(const std::string& program, const std::string& level);

}  // namespace graspdb
