// Calls of services without generated code: bytes in, bytes out.
#pragma once

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <grpcpp/generic/generic_stub.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace graspdb::testing {

// One call of the method, e.g. "/grpc.health.v1.Health/Check". Used from one thread.
class RawCall {
 public:
  // `tokens` are sent as bearer tokens.
  RawCall(const std::shared_ptr<grpc::Channel>& channel, const std::string& method,
          const std::vector<std::string>& tokens = {});
  // Cancels the call and waits for its end.
  ~RawCall();
  RawCall(const RawCall&) = delete;
  RawCall& operator=(const RawCall&) = delete;

  bool Write(const std::string& message);
  // Ends the messages to the server.
  void WritesDone();
  // The next message; nullopt at the end.
  std::optional<std::string> Read();
  // Waits for the end of the call; no other method may be called after it.
  void Cancel() { context_.TryCancel(); }
  grpc::Status Finish();

 private:
  // Waits for the pending operation; returns whether it succeeded.
  bool Wait();

  grpc::ClientContext context_;
  grpc::CompletionQueue queue_;
  grpc::GenericStub stub_;
  std::unique_ptr<grpc::GenericClientAsyncReaderWriter> stream_;
  bool finished_ = false;
};

}  // namespace graspdb::testing
