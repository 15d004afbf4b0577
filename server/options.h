// The server's settings: flags, environment variables, a file.
#pragma once

#include <string>

#include "absl/status/status.h"

namespace graspdb::server {

struct ServerOptions {
  std::string database;
  std::string listen = "127.0.0.1:50051";
  bool allow_remote_without_tls = false;
  int workers = 0;  // frames that are processed at once; 0: one per core
  int queue = 64;   // frames that may wait for a worker
  int max_points = 2'000'000;
  int max_message_mib = 64;
  int memory_mib = 0;         // of the whole server; 0: half of the machine's memory
  int cache_mib = 0;          // part of it for models and clouds; 0: half of it
  int keep_changes = 50'000;  // change records in the database
  double drain_s = 10;
  double voxel_size_m = 0.003;
  double normal_radius_m = 0.010;
  std::string descriptor = "gsh288";
  std::string index = "exact";  // or "flann"
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

// FAILED_PRECONDITION when `listen` is reachable from other machines and this is not
// allowed; INVALID_ARGUMENT when it is not HOST:PORT.
absl::Status CheckListenAddress(const ServerOptions& options);

}  // namespace graspdb::server
