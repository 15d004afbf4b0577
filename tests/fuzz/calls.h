// Calls of a server and checks of their results.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/fuzz/fuzz_server.h"
#include "tests/fuzz/operations.pb.h"

namespace graspdb::fuzz {

// Ends the process if `status` is a fault of the server: INTERNAL, UNKNOWN, UNAVAILABLE or
// DATA_LOSS.
void RequireAnswer(const grpc::Status& status);

class Calls {
 public:
  explicit Calls(FuzzServer& server) : server_(server) {}

  void Do(const Operation& operation);

  // Checks that the status has the number of listed objects and that the revision does not
  // decrease.
  void RequireCounted();
  // Checks that stable poses and views can be listed, and each view read.
  void RequireReadable();
  // Names of objects and cells.
  std::vector<std::string> Listed();
  void DeleteAll();

 private:
  v1::ListObjectsResponse Objects();
  v1::ListCellsResponse Cells();
  void RequireViewsReadable(const std::string& stable_pose);

  FuzzServer& server_;
  std::int64_t revision_ = 0;
};

}  // namespace graspdb::fuzz
