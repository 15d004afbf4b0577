// RocksDB's text log: the files LOG and LOG.old, for developers.
#pragma once

#include <memory>
#include <string>

#include "rocksdb/env.h"

namespace graspdb::storage {

// Writes to LOG in `directory`, which exists, and begins a new file there at 4 MiB. Lines that
// cannot be written, since the disk is full, are left out: RocksDB's own log aborts the process
// then, at the line after one that failed (7.8 as Debian builds it, with assertions). Thread-safe.
std::shared_ptr<rocksdb::Logger> OpenTextLog(const std::string& directory);

}  // namespace graspdb::storage
