// Logging of all programs: one line per event on stderr, `key=value` pairs (logfmt).
#pragma once

#include <memory>
#include <string>

namespace spdlog {
class logger;
}

namespace graspdb {

// To be called once, before threads are started. `level`: debug, info, warn, error or off. gRPC's
// own messages are debug: they are verbose, and ours suggest what to do. Whoever logs waits for the
// reader of stderr; a server has a background log (program/log/background_log.h).
void StartLog(const std::string& program, const std::string& level);

// The same for lines that `logger` writes.
void StartLog(std::shared_ptr<spdlog::logger> logger, const std::string& level);

}  // namespace graspdb
