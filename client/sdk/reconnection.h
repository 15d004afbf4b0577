// Connects again after a call has failed; internal to the client library.
#pragma once

#include <grpcpp/channel.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <thread>

namespace graspdb::client {

// A thread that waits for a channel's next connection, as a call does that has to wait for it.
//
// gRPC reads from the sockets of a channel in threads that wait for an event of that channel, and
// every 5 s. Once an attempt to connect has failed, calls do not wait but fail until another
// attempt succeeds; without a waiting thread, each message of the server takes such an attempt 5 s.
// With TLS it is over before it succeeds (gRPC's issue 33593). Thread-safe.
class Reconnection {
 public:
  explicit Reconnection(std::shared_ptr<grpc::Channel> channel);
  // Takes up to 0.1 s; longer by as much as the wall clock is set back meanwhile (gRPC 32176).
  ~Reconnection();
  Reconnection(const Reconnection&) = delete;
  Reconnection& operator=(const Reconnection&) = delete;

  bool IsConnected() const;
  // Starts the thread if it does not run; it ends with a connection. Without effect where there are
  // no more threads, or where the thread is just ending: to be called after each call that fails.
  void Begin();

 private:
  void Wait();

  const std::shared_ptr<grpc::Channel> channel_;
  std::atomic<bool> stopping_ = false;
  std::mutex mutex_;  // of the next two
  bool waiting_ = false;
  std::thread thread_;
};

}  // namespace graspdb::client
