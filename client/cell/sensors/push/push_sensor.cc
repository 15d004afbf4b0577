#include "client/cell/sensors/push/push_sensor.h"

#include <grpcpp/grpcpp.h>
#include <grpcpp/resource_quota.h>
#include <spdlog/spdlog.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "base/status_macros.h"
#include "files/messages/read_scan.h"
#include "files/messages/scan_message.h"
#include "graspdb/v1/frame_service.grpc.pb.h"
#include "program/connections/connection_acceptor.h"
#include "program/connections/listen_address.h"
#include "program/connections/loopback.h"
#include "program/log/log_field.h"

namespace graspdb::client {
namespace {

// Bytes of a camera's name.
constexpr std::size_t kMaxCameraNameBytes = 256;

// Bytes of a point: with fewer its floats overlap, and the repacked cloud is larger than the
// request.
constexpr int kMinStride = 12;
constexpr int kMaxFields = 64;

absl::Status Wrong(std::string_view field, std::string_view what) {
  return absl::InvalidArgumentError(absl::StrCat(std::string(field), " ", std::string(what)));
}

constexpr files::ScanRules kRules{.wrong = &Wrong, .min_stride = kMinStride, .allows_blank = true};

absl::StatusOr<files::ScanMessage> CheckedImage(const v1::DepthImage& image) {
  recognition::Scan scan;
  RETURN_IF_ERROR(files::ReadScan(image, kRules, "depth_image", &scan));
  const recognition::DepthImage& read = scan.depth_image;
  return files::DepthMessage(read.depth, read.camera, read.unit_m);
}

absl::StatusOr<files::ScanMessage> CheckedCloud(const v1::PointCloud& cloud) {
  if (cloud.fields_size() > kMaxFields) return Wrong("cloud.fields", "are more than 64");
  recognition::Scan scan;
  RETURN_IF_ERROR(files::ReadScan(cloud, kRules, "cloud", &scan));
  const std::size_t count = scan.points.size();
  if (scan.width < 0 || (scan.width > 0 && count % static_cast<std::size_t>(scan.width) != 0)) {
    return Wrong("cloud.width", absl::StrCat("is ", scan.width, ", and ", count,
                                             " points are no rows of it; 0: not organised"));
  }
  return files::CloudMessage(scan.points, scan.width);
}

// How old the scan is.
absl::StatusOr<absl::Duration> AgeOf(const google::protobuf::Timestamp& stamp, absl::Time arrival) {
  // Years 1 to 9999, as documented for Timestamp.
  constexpr std::int64_t kFirst = -62'135'596'800;
  constexpr std::int64_t kLast = 253'402'300'799;
  if (stamp.seconds() < kFirst || stamp.seconds() > kLast || stamp.nanos() < 0 ||
      stamp.nanos() >= 1'000'000'000) {
    return Wrong("capture_time", "is no time");
  }
  const absl::Duration age =
      arrival - absl::FromUnixSeconds(stamp.seconds()) - absl::Nanoseconds(stamp.nanos());
  if (age < absl::ZeroDuration()) {
    return Wrong("capture_time", absl::StrCat("is ", absl::FormatDuration(-age),
                                              " in the future; set the clock of this machine"));
  }
  if (age > kMaxPushedAge) {
    return Wrong(
        "capture_time",
        absl::StrCat("is ", absl::FormatDuration(age),
                     " ago; send frames at once, and compare the clocks of both machines"));
  }
  return age;
}

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

absl::StatusOr<SensorFrame> PushedFrame(const v1::PushFrameRequest& request, absl::Time arrival,
                                        MonotonicTime now) {
  if (request.camera().empty() || request.camera().size() > kMaxCameraNameBytes) {
    return Wrong("camera", "must have 1 to 256 bytes, such as the serial number of the camera");
  }
  const bool is_image = request.has_depth_image();
  if (!is_image && !request.has_cloud()) {
    return Wrong("scan", "is missing: give a cloud or a depth_image");
  }
  const bool has_time =
      is_image ? request.depth_image().has_capture_time() : request.cloud().has_capture_time();
  if (!has_time) return Wrong("capture_time", "is missing; set it to the start of the exposure");
  ASSIGN_OR_RETURN(const absl::Duration age, AgeOf(is_image ? request.depth_image().capture_time()
                                                            : request.cloud().capture_time(),
                                                   arrival));
  ASSIGN_OR_RETURN(files::ScanMessage scan,
                   is_image ? CheckedImage(request.depth_image()) : CheckedCloud(request.cloud()));
  SensorFrame frame = {.scan = std::move(scan)};
  SetTime(now - age, frame);
  return frame;
}

FrameReceiver::FrameReceiver(absl::Duration silence, std::string advice)
    : silence_(silence), frames_(silence, std::move(advice)) {}

absl::Status FrameReceiver::Receive(const v1::PushFrameRequest& request, const std::string& peer,
                                    absl::Time arrival, MonotonicTime now) {
  ASSIGN_OR_RETURN(SensorFrame frame, PushedFrame(request, arrival, now));
  // Held while the frame is stored, so that an older one does not take the place of a newer one.
  const absl::MutexLock lock(&mutex_);
  const bool is_silent = now - last_ > silence_;
  if (camera_ != request.camera()) {
    if (!is_silent) {
      return absl::FailedPreconditionError(absl::StrCat("the frames of the camera ", camera_,
                                                        " come here; end the program that ",
                                                        "pushes them, or push to another agent"));
    }
    camera_ = request.camera();
    newest_ = MonotonicTime::InfinitePast();
  }
  if (frame.time < newest_) {
    return absl::AbortedError("a newer frame of this camera came before; push them in order");
  }
  if (is_silent) {
    spdlog::info("event=frames_pushed camera={} peer={}", LogField(camera_), LogField(peer));
  }
  newest_ = frame.time;
  last_ = now;
  frames_.Put(std::move(frame));
  return absl::OkStatus();
}

bool FrameReceiver::IsReady() const {
  const absl::MutexLock lock(&mutex_);
  return MonotonicTime::Now() - last_ < silence_;
}

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
