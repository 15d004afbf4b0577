// The server with all its components.
#pragma once

#include <grpcpp/server.h>

#include <chrono>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "recognition/base/cancellation.h"
#include "recognition/recognizer.h"
#include "server/base/options.h"

namespace graspdb::server {

class Health;
class WriteWatch;
struct MemoryShares;

// A running server. The destructor drains it.
class Server {
 public:
  // Opens the database, loads the catalogue, starts listening. Error messages suggest
  // what to do. CANCELLED if `is_cancelled` while views are described again; it is called on this
  // thread.
  static absl::StatusOr<std::unique_ptr<Server>> Start(
      const ServerOptions& options, const recognition::IsCancelled& is_cancelled = {});
  ~Server();

  // HOST:PORT, with the selected port.
  const std::string& address() const { return address_; }

  // The same for metrics; empty if there are none.
  std::string metrics_address() const;

  // A channel inside the process, for tests.
  std::shared_ptr<grpc::Channel> InProcessChannel();

  // Notifies health watchers, rejects new calls, waits for running ones until the drain time is
  // over, and closes the database. Calling it again does nothing.
  void Drain();

 private:
  void Stop();
  // Opens the port; its connections wait for Serve(). UNAVAILABLE if the address is in use.
  absl::Status Listen(const ServerOptions& options);
  // Answers calls.
  absl::Status Serve(const ServerOptions& options, const MemoryShares& memory);

  struct Parts;
  explicit Server(std::unique_ptr<Parts> parts);

  std::unique_ptr<Parts> parts_;
  std::unique_ptr<grpc::Server> grpc_;
  std::unique_ptr<Health> health_;
  std::unique_ptr<WriteWatch> write_watch_;
  std::string address_;
  std::chrono::duration<double> drain_time_{};
};

}  // namespace graspdb::server
