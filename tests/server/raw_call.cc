#include "tests/server/raw_call.h"

#include <grpcpp/support/byte_buffer.h>

namespace graspdb::testing {

RawCall::RawCall(const std::shared_ptr<grpc::Channel>& channel, const std::string& method,
                 const std::vector<std::string>& tokens)
    : stub_(channel), stream_(stub_.PrepareCall(&context_, method, &queue_)) {
  for (const std::string& token : tokens) context_.AddMetadata("authorization", "Bearer " + token);
  stream_->StartCall(this);
  Wait();
}

RawCall::~RawCall() {
  context_.TryCancel();
  if (!finished_) (void)Finish();
  queue_.Shutdown();
}

grpc::Status RawCall::Finish() {
  grpc::Status status;
  stream_->Finish(&status, this);
  Wait();
  finished_ = true;
  return status;
}

bool RawCall::Write(const std::string& message) {
  const grpc::Slice slice(message);
  stream_->Write(grpc::ByteBuffer(&slice, 1), this);
  return Wait();
}

void RawCall::WritesDone() {
  stream_->WritesDone(this);
  Wait();
}

std::optional<std::string> RawCall::Read() {
  grpc::ByteBuffer buffer;
  stream_->Read(&buffer, this);
  if (!Wait()) return std::nullopt;
  std::vector<grpc::Slice> slices;
  if (!buffer.Dump(&slices).ok()) return std::nullopt;
  std::string out;
  for (const grpc::Slice& slice : slices) {
    out.append(reinterpret_cast<const char*>(slice.begin()), slice.size());
  }
  return out;
}

bool RawCall::Wait() {
  void* tag = nullptr;
  bool ok = false;
  return queue_.Next(&tag, &ok) && ok;
}

}  // namespace graspdb::testing
