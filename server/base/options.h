// The server's settings: flags, environment variables, a file.
#pragma once

#include <optional>
#include <string>

#include "absl/status/status.h"
#include "program/metrics/metrics_server.h"
#include "server/access/tls.h"

namespace graspdb::server {

struct ServerOptions {
  std::string database;
  std::string listen = "127.0.0.1:50051";
  bool allow_remote_without_tls = false;
  TlsFiles tls = {};
  bool no_reflection = false;
  MetricsOptions metrics = {};
  std::string identities;  // file; empty: every caller may make all calls
  std::string audit_log;   // file; empty: none
  int audit_log_mib = 64;  // of a full file
  int workers = 0;         // frames that are processed at once; 0: one per core
  // Frames that may wait for a worker; absent: one per worker, at least 2.
  std::optional<int> queue = std::nullopt;
  int max_points = 2'000'000;
  int max_message_mib = 64;
  int memory_mib = 0;          // of the whole server; 0: half of the machine's memory
  int cache_mib = 0;           // part of it for models and clouds; 0: half of it
  int disk_reserve_mib = 128;  // for what frees space; 0: none
  int keep_changes = 50'000;   // change records in the database
  double deleted_objects_kept_s = 30 * 24 * 3600.0;  // and earlier revisions of objects
  std::string backup_dir;                            // folder of the backups; empty: none
  double backup_every_s = 0;     // interval of scheduled backups; 0: none are scheduled
  int backup_keep = 14;          // backups that are kept; 0: all
  double backup_rate_mib = 100;  // MiB a second that a backup copies at most; 0: no limit
  double backup_max_age_s = 0;   // age at which backups are deleted; 0: never
  double drain_s = 10;
  double voxel_size_m = 0.003;
  double normal_radius_m = 0.010;
  std::string descriptor = "gsh288";
  std::string index = {};  // of earlier versions; "flann" gets a warning, and has no effect
  std::string log_level = "info";
};

// The result of parsing the command line.
struct ParsedOptions {
  ServerOptions options;
  bool done = false;    // help, version or an error was printed
  int exit_status = 0;  // 2 when the usage is wrong
};

// Reads the command line, GRASPDB_... variables and the file of --config, in this
// order of precedence. Prints help, version and errors.
ParsedOptions ParseOptions(int argc, char** argv);

// FAILED_PRECONDITION when `listen` is reachable from other machines without TLS and this is not
// allowed; INVALID_ARGUMENT when it is not HOST:PORT.
absl::Status CheckListenAddress(const ServerOptions& options);

// Logs what other machines may do, where it is more than intended for most networks.
void WarnIfOpen(const ServerOptions& options);

}  // namespace graspdb::server
