// Calls of a server without the gateway, of any method as bytes.
#pragma once

#include <grpcpp/channel.h>
#include <grpcpp/completion_queue.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/support/byte_buffer.h>

#include <cstddef>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace graspdb::testing {

struct DirectResponse {
  grpc::Status status;
  std::vector<std::string> messages;
};

// The bytes of each response. After `most` messages the call is cancelled.
inline DirectResponse DirectCall(const std::shared_ptr<grpc::Channel>& channel,
                                 const std::string& path, const std::string& request,
                                 std::size_t most = std::numeric_limits<std::size_t>::max()) {
  grpc::GenericStub stub(channel);
  grpc::ClientContext context;
  grpc::CompletionQueue queue;
  const auto ends_well = [&queue] {
    void* tag = nullptr;
    bool ok = false;
    return queue.Next(&tag, &ok) && ok;
  };
  const auto call = stub.PrepareCall(&context, path, &queue);
  DirectResponse out;
  call->StartCall(nullptr);
  bool goes_on = ends_well();
  if (goes_on) {
    const grpc::Slice slice(request);
    call->WriteLast(grpc::ByteBuffer(&slice, 1), grpc::WriteOptions(), nullptr);
    goes_on = ends_well();
  }
  while (goes_on && out.messages.size() < most) {
    grpc::ByteBuffer message;
    call->Read(&message, nullptr);
    goes_on = ends_well();
    grpc::Slice slice;
    if (goes_on && message.DumpToSingleSlice(&slice).ok()) {
      out.messages.emplace_back(slice.begin(), slice.end());
    }
  }
  if (goes_on) context.TryCancel();
  call->Finish(&out.status, nullptr);
  ends_well();
  queue.Shutdown();
  while (ends_well()) {
  }
  return out;
}

}  // namespace graspdb::testing
