#include "client/cell/sensors/push/push_sensor.h"

#include <grpcpp/grpcpp.h>
#include <grpcpp/resource_quota.h>

#include <atomic>
#include <chrono>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "base/status_macros.h"
#include "client/cell/sensors/push/frame_receiver.h"
#include "graspdb/v1/frame_service.grpc.pb.h"
#include "program/connections/connection_acceptor.h"
#include "program/connections/listen_address.h"
#include "program/connections/loopback.h"

namespace graspdb::client {
namespace {

// Of a frame: a cloud of 5 million points has 60 MB.
constexpr int kMaxMessageBytes = 64 << 20;
// When its memory is exhausted, gRPC stops reading.
constexpr std::size_t kMemoryBytes = std::size_t{256} << 20U;
// Frames that are checked at the same time.
constexpr int kMaxCalls = 4;
constexpr int kCallsOfConnection = 4;
// A new connection must begin with HTTP/2 within this time.
constexpr int kHandshakeMs = 20'000;
// A silent client is pinged after 30 s, and gone after another 20 s.
constexpr int kKeepaliveMs = 30'000;
constexpr int kKeepaliveTimeoutMs = 20'000;

absl::StatusOr<ListenAddress> AddressOf(const std::string& where, bool allow_remote) {
  const bool has_host = where.find(':') != std::string::npos;
  absl::StatusOr<ListenAddress> address =
      ParseListenAddress("push", has_host ? where : absl::StrCat("127.0.0.1:", where));
  if (!address.ok()) {
    return absl::InvalidArgumentError(absl::StrCat(
        "the sensor push:", where, " has no port; write push:PORT, such as push:7110"));
  }
  if (allow_remote || IsLoopback(address->host)) return address;
  return absl::FailedPreconditionError(absl::StrCat(
      "push:", where, " can be reached from other machines, without encryption or password; ",
      "write push:", where, "?allow-remote if only the cell's network reaches it"));
}

}  // namespace

class PushSensor::Server {
 public:
  Server(std::string address, std::unique_ptr<ConnectionAcceptor> acceptor, absl::Duration silence)
      : address_(std::move(address)),
        acceptor_(std::move(acceptor)),
        frames_(silence, absl::StrCat("does a program push frames to ", address_, "?")),
        service_(frames_) {}

  ~Server() {
    acceptor_->Stop();
    if (grpc_ != nullptr) grpc_->Shutdown(std::chrono::system_clock::now());
  }
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  absl::Status Start() {
    grpc::ServerBuilder builder;
    builder.SetMaxReceiveMessageSize(kMaxMessageBytes);
    grpc::ResourceQuota quota("push");
    quota.Resize(kMemoryBytes);
    builder.SetResourceQuota(quota);
    builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS, kCallsOfConnection);
    builder.AddChannelArgument(GRPC_ARG_SERVER_HANDSHAKE_TIMEOUT_MS, kHandshakeMs);
    builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, kKeepaliveMs);
    builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, kKeepaliveTimeoutMs);
    acceptor_->AddTo(builder, grpc::InsecureServerCredentials());
    builder.RegisterService(&service_);
    grpc_ = builder.BuildAndStart();
    if (grpc_ == nullptr) return absl::InternalError("gRPC does not start for pushed frames");
    acceptor_->Start();
    return absl::OkStatus();
  }

  FrameReceiver& frames() { return frames_; }
  const std::string& address() const { return address_; }

 private:
  class Service : public v1::FrameService::CallbackService {
   public:
    explicit Service(FrameReceiver& frames) : frames_(frames) {}

    grpc::ServerUnaryReactor* PushFrame(grpc::CallbackServerContext* context,
                                        const v1::PushFrameRequest* request,
                                        v1::PushFrameResponse* /*response*/) override {
      grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
      reactor->Finish(StatusOf(*context, *request));
      return reactor;
    }

   private:
    grpc::Status StatusOf(const grpc::CallbackServerContext& context,
                          const v1::PushFrameRequest& request) {
      const absl::Time arrival = absl::Now();
      const MonotonicTime now = MonotonicTime::Now();
      if (context.IsCancelled()) return grpc::Status::CANCELLED;
      const int others = calls_.fetch_add(1);
      grpc::Status out;
      if (others >= kMaxCalls) {
        out = grpc::Status(grpc::StatusCode::RESOURCE_EXHAUSTED,
                           "too many frames are pushed at once; push one after the other");
      } else if (const absl::Status status = frames_.Receive(request, context.peer(), arrival, now);
                 !status.ok()) {
        out = grpc::Status(static_cast<grpc::StatusCode>(status.code()),
                           std::string(status.message()));
      }
      calls_.fetch_sub(1);
      return out;
    }

    FrameReceiver& frames_;
    std::atomic<int> calls_ = 0;  // in progress
  };

  const std::string address_;
  const std::unique_ptr<ConnectionAcceptor> acceptor_;
  FrameReceiver frames_;
  Service service_;
  std::unique_ptr<grpc::Server> grpc_;
};

PushSensor::PushSensor(std::unique_ptr<Server> server) : server_(std::move(server)) {}
PushSensor::~PushSensor() = default;

absl::StatusOr<std::unique_ptr<PushSensor>> PushSensor::Listen(const std::string& where,
                                                               bool allow_remote,
                                                               const SensorSettings& settings) {
  ASSIGN_OR_RETURN(const ListenAddress address, AddressOf(where, allow_remote));
  absl::StatusOr<std::unique_ptr<ConnectionAcceptor>> acceptor =
      ConnectionAcceptor::Listen(address);
  if (!acceptor.ok()) {
    return absl::FailedPreconditionError(absl::StrCat(
        "cannot listen on ", address.host, ":", address.port, " for pushed frames (",
        acceptor.status().message(), "); is the port in use? Write push:PORT with another one"));
  }
  const std::string at = absl::StrCat(address.host, ":", (*acceptor)->port());
  auto server = std::make_unique<Server>(at, *std::move(acceptor), settings.silence);
  RETURN_IF_ERROR(server->Start());
  return std::unique_ptr<PushSensor>(new PushSensor(std::move(server)));
}

absl::StatusOr<SensorFrame> PushSensor::Next(MonotonicTime deadline) {
  return server_->frames().Wait(MonotonicTime::Now(), deadline);
}

bool PushSensor::IsReady() { return server_->frames().IsReady(); }

std::string PushSensor::Name() const {
  return absl::StrCat("frames pushed to ", server_->address());
}

const std::string& PushSensor::address() const { return server_->address(); }

}  // namespace graspdb::client
