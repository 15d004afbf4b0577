#include "console/grpc_upstream.h"

#include <grpcpp/client_context.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/support/byte_buffer.h>

#include <atomic>
#include <utility>

#include "absl/time/clock.h"
#include "client/sdk/connection.h"
#include "client/sdk/security.h"
#include "program/log/request_id.h"

namespace graspdb::console {
namespace {

// One sends while the other one converts; more did not shorten calls on two cores.
constexpr int kQueueThreads = 2;

std::shared_ptr<grpc::Channel> Connect(const client::ConnectionOptions& options, bool with_token) {
  grpc::ChannelArguments arguments = client::ChannelArgumentsFor(options.server);
  arguments.SetInt(GRPC_ARG_ENABLE_RETRIES, 0);
  auto interceptors = client::MakeTokenInterceptors(options);
  if (!with_token) interceptors.clear();
  return grpc::experimental::CreateCustomChannelWithInterceptors(
      options.server, client::MakeCredentials(options.security), arguments,
      std::move(interceptors));
}

std::string Bytes(const grpc::ByteBuffer& buffer) {
  std::string out;
  out.reserve(buffer.Length());
  std::vector<grpc::Slice> slices;
  if (!buffer.Dump(&slices).ok()) return out;
  for (const grpc::Slice& slice : slices) {
    out.append(reinterpret_cast<const char*>(slice.begin()), slice.size());
  }
  return out;
}

grpc::ByteBuffer Buffer(const std::string& bytes) {
  const grpc::Slice slice(bytes);
  return {&slice, 1};
}

}  // namespace

// The queue's tag of its operations. Keeps itself until the end.
class GrpcUpstream::Call : public UpstreamCall, public std::enable_shared_from_this<Call> {
 public:
  Call(GrpcUpstream& upstream, const UpstreamRequest& request, OnEvent on_event)
      : upstream_(upstream),
        has_own_authorization_(!request.authorization.empty()),
        on_event_(std::move(on_event)) {
    if (request.timeout) context_.set_deadline(absl::ToChronoTime(absl::Now() + *request.timeout));
    if (has_own_authorization_) context_.AddMetadata("authorization", request.authorization);
    if (!request.request_id.empty()) context_.AddMetadata(kRequestIdKey, request.request_id);
  }

  void Begin(const UpstreamRequest& request) {
    const std::scoped_lock lock(upstream_.begin_);
    self_ = shared_from_this();
    Send(has_own_authorization_ ? upstream_.open_stub_ : upstream_.stub_, request);
  }
  // An operation has ended.
  void OnOperation(bool ok) {
    // What Begin() and the constructor have written is visible from here on, however the queue
    // passes on its tags. So the lock is not one of the call.
    { const std::scoped_lock lock(upstream_.begin_); }
    Proceed(ok);
  }

 protected:
  virtual void Proceed(bool ok) = 0;
  virtual void Send(grpc::GenericStub& stub, const UpstreamRequest& request) = 0;
  void Deliver(UpstreamEvent event) { on_event_(std::move(event)); }
  // Nothing of the call may be used afterwards.
  void End(UpstreamEvent event) {
    event.end = upstream_.EndOf(status_, context_, has_own_authorization_);
    Deliver(std::move(event));
    on_event_ = nullptr;
    const std::shared_ptr<Call> self = std::move(self_);
    upstream_.Remove(this);
  }
  grpc::CompletionQueue* queue() { return &upstream_.queue_; }

  GrpcUpstream& upstream_;
  grpc::ClientContext context_;
  grpc::Status status_;

 private:
  const bool has_own_authorization_;
  OnEvent on_event_;
  std::shared_ptr<Call> self_;
};

class GrpcUpstream::UnaryCall : public Call {
 public:
  using Call::Call;
  void Next() override {}
  void Cancel() override { context_.TryCancel(); }

  void Proceed(bool /*ok*/) override {
    UpstreamEvent event;
    if (status_.ok()) event.message = Bytes(response_);
    End(std::move(event));
  }

 private:
  void Send(grpc::GenericStub& stub, const UpstreamRequest& request) override {
    reader_ = stub.PrepareUnaryCall(&context_, request.path, Buffer(request.message), queue());
    reader_->StartCall();
    reader_->Finish(&response_, &status_, static_cast<Call*>(this));
  }

  std::unique_ptr<grpc::GenericClientAsyncResponseReader> reader_;
  grpc::ByteBuffer response_;
};

class GrpcUpstream::StreamCall : public Call {
 public:
  using Call::Call;

  void Next() override {
    if (is_waiting_.exchange(false)) stream_->Read(&response_, static_cast<Call*>(this));
  }

  // A call that waits for Next() would not notice.
  void Cancel() override {
    is_cancelled_ = true;
    context_.TryCancel();
    Next();
  }

  void Proceed(bool ok) override {
    const std::shared_ptr<Call> self = shared_from_this();  // until the return
    if (step_ == Step::kFinish) return End({});
    if (!ok) {
      step_ = Step::kFinish;
      stream_->Finish(&status_, static_cast<Call*>(this));
    } else if (step_ == Step::kStart) {
      step_ = Step::kWrite;
      stream_->WriteLast(request_, grpc::WriteOptions(), static_cast<Call*>(this));
    } else if (step_ == Step::kWrite) {
      step_ = Step::kRead;
      stream_->Read(&response_, static_cast<Call*>(this));
    } else {
      UpstreamEvent event{.message = Bytes(response_)};
      response_.Clear();
      is_waiting_ = true;
      Deliver(std::move(event));
      // Who cancels it meanwhile takes no message any more.
      if (is_cancelled_) Next();
    }
  }

 private:
  enum class Step { kStart, kWrite, kRead, kFinish };

  void Send(grpc::GenericStub& stub, const UpstreamRequest& request) override {
    request_ = Buffer(request.message);
    stream_ = stub.PrepareCall(&context_, request.path, queue());
    stream_->StartCall(static_cast<Call*>(this));
  }

  Step step_ = Step::kStart;
  std::atomic<bool> is_waiting_ = false;  // for Next()
  std::atomic<bool> is_cancelled_ = false;
  std::unique_ptr<grpc::GenericClientAsyncReaderWriter> stream_;
  grpc::ByteBuffer request_;
  grpc::ByteBuffer response_;
};

GrpcUpstream::GrpcUpstream(const client::ConnectionOptions& options)
    : options_(options),
      tls_files_(client::WatchTlsFiles(options.security)),
      channel_(Connect(options, true)),
      open_channel_(Connect(options, false)),
      stub_(channel_),
      open_stub_(open_channel_),
      reconnection_(channel_),
      open_reconnection_(open_channel_) {
  for (int i = 0; i < kQueueThreads; ++i) {
    threads_.emplace_back([this] {
      void* tag = nullptr;
      bool ok = false;
      while (queue_.Next(&tag, &ok)) static_cast<Call*>(tag)->OnOperation(ok);
    });
  }
}

GrpcUpstream::~GrpcUpstream() {
  std::vector<std::shared_ptr<UpstreamCall>> calls;
  {
    const std::scoped_lock lock(mutex_);
    for (Call* call : calls_) calls.push_back(call->shared_from_this());
  }
  for (const auto& call : calls) call->Cancel();
  calls.clear();
  {
    std::unique_lock lock(mutex_);
    ended_.wait(lock, [this] { return calls_.empty(); });
  }
  queue_.Shutdown();
  for (std::thread& thread : threads_) thread.join();
}

void GrpcUpstream::Remove(Call* call) {
  const std::scoped_lock lock(mutex_);
  calls_.erase(call);
  if (calls_.empty()) ended_.notify_all();
}

std::shared_ptr<UpstreamCall> GrpcUpstream::Start(UpstreamRequest request, OnEvent on_event) {
  std::shared_ptr<Call> call;
  if (request.is_stream) {
    call = std::make_shared<StreamCall>(*this, request, std::move(on_event));
  } else {
    call = std::make_shared<UnaryCall>(*this, request, std::move(on_event));
  }
  {
    const std::scoped_lock lock(mutex_);
    calls_.insert(call.get());
  }
  call->Begin(request);
  return call;
}

UpstreamEvent::End GrpcUpstream::EndOf(const grpc::Status& status,
                                       const grpc::ClientContext& context,
                                       bool has_own_authorization) {
  client::ConnectionOptions options = options_;
  // An error of authentication is then not one of the file.
  if (has_own_authorization) options.security.token_file.clear();
  UpstreamEvent::End out{.status = client::Explain(status, options), .request_id = {}};
  client::Reconnection& reconnection = has_own_authorization ? open_reconnection_ : reconnection_;
  if ((absl::IsUnavailable(out.status) || absl::IsDeadlineExceeded(out.status)) &&
      !reconnection.IsConnected()) {
    reconnection.Begin();
  }
  const auto& trailing = context.GetServerTrailingMetadata();
  const auto id = trailing.find(kRequestIdKey);
  if (id != trailing.end()) out.request_id.assign(id->second.data(), id->second.size());
  return out;
}

}  // namespace graspdb::console
