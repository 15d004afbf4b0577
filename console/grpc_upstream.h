// Calls of a server over gRPC.
#pragma once

#include <grpcpp/channel.h>
#include <grpcpp/completion_queue.h>
#include <grpcpp/generic/generic_stub.h>

#include <condition_variable>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "client/sdk/client.h"
#include "client/sdk/connection.h"
#include "console/upstream.h"
#include "program/tls/watched_files.h"

namespace graspdb::console {

// Threads of its own take what comes from the server. Connects with the first call; a lost
// connection is made again. Thread-safe.
class GrpcUpstream : public Upstream {
 public:
  // For options that pass client::CheckOptions. Calls with the caller's own authorization do not
  // send the token of the options.
  explicit GrpcUpstream(const client::ConnectionOptions& options);
  // Cancels the calls in progress and waits for their ends. No call may start meanwhile.
  ~GrpcUpstream() override;
  GrpcUpstream(const GrpcUpstream&) = delete;
  GrpcUpstream& operator=(const GrpcUpstream&) = delete;

  std::shared_ptr<UpstreamCall> Start(UpstreamRequest request, OnEvent on_event) override;

 private:
  class Call;
  class UnaryCall;
  class StreamCall;

  void Remove(Call* call);
  // The end of a call with `context`.
  UpstreamEvent::End EndOf(const grpc::Status& status, const grpc::ClientContext& context,
                           bool has_own_authorization);

  const client::ConnectionOptions options_;
  const std::unique_ptr<WatchedFiles> tls_files_;  // null: none
  const std::shared_ptr<grpc::Channel> channel_;   // with the token of the options
  const std::shared_ptr<grpc::Channel> open_channel_;
  grpc::GenericStub stub_;
  grpc::GenericStub open_stub_;
  client::Reconnection reconnection_;
  client::Reconnection open_reconnection_;
  grpc::CompletionQueue queue_;
  std::mutex begin_;  // while a call is begun
  std::mutex mutex_;  // of the next two
  std::condition_variable ended_;
  std::set<Call*> calls_;  // in progress
  std::vector<std::thread> threads_;
};

}  // namespace graspdb::console
