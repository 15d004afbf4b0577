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
// gRPC reads from the sockets of a channel in threads that wait for something of that channel, and
// every 5 s. Calls do not wait once an attempt to connect has failed: they fail until another one
// succeeds, and this one takes 5 s for each message of the server. With TLS that is longer than
// attempts last (gRPC's issue 33593). Thread-safe.
class Reconnection {
 public:
  explicit Reconnection(std::shared_ptr<grpc::Channel> channel);
  // Takes up to 0.1 s.
  ~Reconnection();
  Reconnection(const Reconnection&) = delete;
  Reconnection& operator=(const Reconnection&) = delete;

  // Starts the thread if there is neither a connection nor the thread; it ends with a connection.
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
