// The state of the database and its disk: figures for monitoring, faults, damage.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "absl/time/time.h"

namespace graspdb::storage {

class Database;

// Why a database cannot be written.
struct WriteFault {
  absl::Status error;  // OK: writes succeed
  absl::Time begin;    // of the fault
};

// A file of a database that is missing or damaged.
struct DamagedFile {
  std::string name;   // in the folder of the database
  std::string error;  // what is wrong
  bool is_lost;       // the file is missing or too short; else a read has found it damaged
};

// Bytes, unless stated otherwise; 0 where the database does not report a figure.
struct DatabaseStatus {
  std::uint64_t table_bytes = 0;     // sorted files
  std::uint64_t blob_bytes = 0;      // clouds, in files beside the sorted ones
  std::uint64_t memtable_bytes = 0;  // in memory, and in the logs
  std::uint64_t block_cache_bytes = 0;
  std::uint64_t pending_compaction_bytes = 0;  // estimate of what compactions have to rewrite
  std::uint64_t running_compactions = 0;       // number
  std::uint64_t background_errors = 0;         // number, of flushes and compactions since the start
  bool writes_stopped = false;                 // until compactions have caught up
  WriteFault write_fault;
  std::string reserve_error;               // why there is no reserve of disk space; empty: none
  std::uint64_t disk_available_bytes = 0;  // of the database's file system, for this process
  std::uint64_t disk_bytes = 0;
};

// Reads counters of RocksDB and of the file system: some microseconds. Thread-safe.
DatabaseStatus StatusOf(Database& database);

}  // namespace graspdb::storage
