// Distinguishes a log truncated by a crash from a log that was damaged later.
//
// RocksDB replays a write-ahead log up to the first record that it cannot read and
// drops the rest. After a crash that is right: the rest is one write that was never
// acknowledged. After a flipped bit it would silently drop acknowledged writes. A
// write begins only after the previous one is on the disk, so an intact write *after*
// an unreadable record proves damage, and only that does.
//
// Not detected: damage to the very last write of the newest log looks like a crash during
// that write. After a clean shutdown revision_floor.h detects that as well.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/status.h"

namespace graspdb::storage {

// The result of inspecting one log.
struct LogVerdict {
  // Whether every record up to the end (or up to a tail of zeros) is intact.
  bool complete = true;
  // Whether an intact write follows a record that cannot be read.
  bool damaged = false;
  // Whether the log has at least one intact write.
  bool has_writes = false;
};

// Reads `log`, the bytes of a file in RocksDB's log format (write-ahead logs and
// manifests). Pure; safe from any thread.
LogVerdict InspectLog(std::string_view log);

// Inspects all logs and manifests of the database in `directory`, which should not
// be open. DATA_LOSS, naming the file, when one is damaged or when a log that is not
// the newest is incomplete. Files that are deleted meanwhile, or cannot be read, are skipped.
absl::Status CheckLogs(const std::string& directory);

}  // namespace graspdb::storage
