// `graspdb-server token`.
#pragma once

namespace graspdb::server {

// Prints a new token and its line for the file of identities. `argv` begins with "token". Returns
// the exit status: 0, 1 if it failed, 2 for wrong usage.
int RunTokenCommand(int argc, char** argv);

}  // namespace graspdb::server
