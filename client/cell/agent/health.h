// A health service over gRPC (grpc.health.v1), for those who watch a cell.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "absl/time/time.h"

namespace graspdb::client {

// Says SERVING, of "" and "graspdb.cell", while `is_ready`, and NOT_SERVING else. `is_ready` is
// asked every `period`, on a thread of this.
class Health {
 public:
  // Listens at HOST:PORT; port 0 picks one. UNAVAILABLE when that cannot be listened on.
  static absl::StatusOr<std::unique_ptr<Health>> Start(const std::string& listen,
                                                       std::function<bool()> is_ready,
                                                       absl::Duration period);
  ~Health();
  Health(const Health&) = delete;
  Health& operator=(const Health&) = delete;

  const std::string& address() const;

 private:
  class Watch;
  explicit Health(std::unique_ptr<Watch> watch);
  std::unique_ptr<Watch> watch_;
};

}  // namespace graspdb::client
