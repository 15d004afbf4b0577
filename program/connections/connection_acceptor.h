// Accepts connections for gRPC.
//
// The listener of Debian's gRPC 1.51 stops for good when accept() finds no free descriptor: later
// connections wait in the kernel, also after all others are closed. This one goes on
// (docs/adr/0036-connections-are-accepted-by-the-programs.md).
#pragma once

#include <grpcpp/security/server_credentials.h>
#include <grpcpp/server_builder.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <string_view>
#include <thread>

#include "absl/status/statusor.h"
#include "program/connections/connection_shares.h"
#include "program/connections/connection_watch.h"
#include "program/connections/file_descriptor.h"
#include "program/connections/listen_address.h"
#include "program/connections/listening_sockets.h"
#include "program/log/log_interval.h"

namespace graspdb {

// Accepts connections on a thread of its own and passes them to a gRPC server. A quarter of the
// descriptors is kept for files, and one address gets half of what open files leave of the others:
// connections beyond that are closed at once, counted and logged. Thread-safe.
class ConnectionAcceptor {
 public:
  // Listens, so that connections wait from now on. UNAVAILABLE as ListenAt().
  static absl::StatusOr<std::unique_ptr<ConnectionAcceptor>> Listen(const ListenAddress& address);
  ~ConnectionAcceptor();
  ConnectionAcceptor(const ConnectionAcceptor&) = delete;
  ConnectionAcceptor& operator=(const ConnectionAcceptor&) = delete;

  std::uint16_t port() const { return listening_.port; }

  // The server to be built gets the connections, which use the credentials.
  void AddTo(grpc::ServerBuilder& builder, std::shared_ptr<grpc::ServerCredentials> credentials);
  // To be called when the server runs, after AddTo(). `watch`: not owned, outlives the acceptor's
  // thread; null: none.
  void Start(ConnectionWatch* watch = nullptr);
  // Closes the sockets. To be called before the server ends. Calling it again does nothing.
  void Stop();

  // Connections that were closed at once.
  std::int64_t refused_count() const { return refused_; }

 private:
  explicit ConnectionAcceptor(ListeningSockets listening, FileDescriptor stop);

  void Run();
  // Waits for connections; false when the acceptor ends.
  bool AwaitConnections();
  void AcceptAll(int listener);
  void Pass(int listener, FileDescriptor connection);
  // Closes the connection that waits longest, although there is no descriptor for it: its client
  // learns of it, and the kernel's queue stays free.
  void RefuseWithoutDescriptor(int listener, int error);
  void NoteRefusal(std::string_view reason, std::string_view advice);

  ListeningSockets listening_;
  const FileDescriptor stop_;  // readable when the acceptor ends
  FileDescriptor spare_;       // closed to make room for the next connection
  const int descriptor_limit_;
  const int max_connection_;  // number of the last descriptor that a connection may have
  std::unique_ptr<grpc::experimental::ExternalConnectionAcceptor> server_;
  ConnectionShares shares_;  // of the thread
  std::atomic<std::int64_t> refused_ = 0;
  LogInterval refusals_;
  ConnectionWatch* watch_ = nullptr;
  std::thread thread_;
};

}  // namespace graspdb
