// Calls of a server, and what must hold after them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/fuzz/fuzz_server.h"
#include "tests/fuzz/operations.pb.h"

namespace graspdb::fuzz {

// Ends the process where `status` is a fault of the server: INTERNAL, UNKNOWN, UNAVAILABLE or
// DATA_LOSS.
void RequireAnswer(const grpc::Status& status);

class Calls {
 public:
  explicit Calls(FuzzServer& server) : server_(server) {}

  void Do(const Operation& operation);

  // The status counts the objects that are listed, and the revision does not go back.
  void RequireCounted();
  // Stable poses and views can be listed, and views be read one by one.
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
