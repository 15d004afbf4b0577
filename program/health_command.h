// `PROGRAM health`: for the health checks of containers and supervisors.
#pragma once

#include <string>

namespace graspdb {

// Calls Check of grpc.health.v1 at `address`, or at the address of the command line, and prints its
// status. `argv` begins with "health". Returns the exit status: 0 if it is SERVING, 1 if it is not
// or does not answer within --timeout, 2 for wrong usage.
int RunHealthCommand(const std::string& program, std::string address, int argc, char** argv);

}  // namespace graspdb
