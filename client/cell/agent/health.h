// A gRPC health service (grpc.health.v1) for monitoring a cell.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "absl/time/time.h"

namespace graspdb::client {

// Reports SERVING for "" and "graspdb.cell" while `is_ready` returns true, otherwise NOT_SERVING.
// `is_ready` is called every `period` on a thread of this.
class Health {
 public:
  // Listens at HOST:PORT; port 0 picks one. UNAVAILABLE when it cannot listen there.
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
