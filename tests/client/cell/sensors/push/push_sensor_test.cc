// Frames pushed over gRPC.
#include "client/cell/sensors/push/push_sensor.h"

#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>

#include <thread>

#include "absl/time/clock.h"
#include "graspdb/v1/frame_service.grpc.pb.h"
#include "tests/client/cell/sensors/push/pushed_requests.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::StatusIs;

class PushSensorTest : public ::testing::Test {
 protected:
  void SetUp() override { Listen(absl::Hours(1)); }

  void Listen(absl::Duration silence) {
    SensorSettings settings;
    settings.silence = silence;
    auto sensor = PushSensor::Listen("0", /*allow_remote=*/false, settings);
    ASSERT_THAT(sensor, IsOk());
    sensor_ = *std::move(sensor);
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
    arguments.SetMaxSendMessageSize(-1);
    stub_ = v1::FrameService::NewStub(grpc::CreateCustomChannel(
        sensor_->address(), grpc::InsecureChannelCredentials(), arguments));
  }

  grpc::Status Push(const v1::PushFrameRequest& request) {
    grpc::ClientContext context;
    v1::PushFrameResponse response;
    return stub_->PushFrame(&context, request, &response);
  }

  // Pushes frames until the destruction.
  class Pusher {
   public:
    explicit Pusher(PushSensorTest& test)
        : thread_([this, &test] {
            while (!stop_) EXPECT_TRUE(test.Push(ImageRequest(absl::Now())).ok());
          }) {}
    ~Pusher() {
      stop_ = true;
      thread_.join();
    }
    Pusher(const Pusher&) = delete;
    Pusher& operator=(const Pusher&) = delete;

   private:
    std::atomic<bool> stop_ = false;
    std::thread thread_;
  };

  absl::StatusOr<SensorFrame> Next() {
    return sensor_->Next(MonotonicTime::Now() + absl::Minutes(5));
  }

  std::unique_ptr<PushSensor> sensor_;
  std::unique_ptr<v1::FrameService::Stub> stub_;
};

TEST_F(PushSensorTest, GivesFramesThatWereExposedAfterTheCall) {
  EXPECT_EQ(sensor_->Name(), "frames pushed to " + sensor_->address());
  EXPECT_FALSE(sensor_->IsReady());
  const Pusher pusher(*this);
  for (int i = 0; i < 3; ++i) {
    const MonotonicTime before = MonotonicTime::Now();
    const auto frame = Next();
    ASSERT_THAT(frame, IsOk());
    EXPECT_GE(frame->time, before);
  }
  EXPECT_TRUE(sensor_->IsReady());
}

TEST_F(PushSensorTest, ReportsSilenceAtOnce) {
  Listen(absl::Milliseconds(1));
  EXPECT_THAT(Next(), StatusIs(absl::StatusCode::kUnavailable,
                               AllOf(HasSubstr("does a program push"), HasSubstr("127.0.0.1:"))));
}

TEST_F(PushSensorTest, RefusesBadFramesAndASecondCamera) {
  const grpc::Status bad = Push(v1::PushFrameRequest());
  EXPECT_EQ(bad.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(bad.error_message(), HasSubstr("camera"));
  ASSERT_TRUE(Push(ImageRequest(absl::Now())).ok());
  v1::PushFrameRequest other = ImageRequest(absl::Now());
  other.set_camera("right");
  EXPECT_EQ(Push(other).error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  EXPECT_TRUE(Push(ImageRequest(absl::Now())).ok());
}

TEST_F(PushSensorTest, RefusesMessagesThatAreTooLarge) {
  v1::PushFrameRequest large = ImageRequest(absl::Now());
  large.mutable_depth_image()->mutable_data()->resize(std::size_t{64} << 20U);
  EXPECT_EQ(Push(large).error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_TRUE(Push(ImageRequest(absl::Now())).ok());
}

TEST_F(PushSensorTest, CancelledCallsLeaveNothingBehind) {
  v1::PushFrameRequest request = ImageRequest(absl::Now());
  request.mutable_depth_image()->mutable_intrinsics()->set_width(2'000'000);
  request.mutable_depth_image()->mutable_data()->resize(std::size_t{12'000'000});
  grpc::CompletionQueue queue;
  for (int i = 0; i < 20; ++i) {
    grpc::ClientContext context;
    v1::PushFrameResponse response;
    grpc::Status status;
    const auto call = stub_->AsyncPushFrame(&context, request, &queue);
    call->Finish(&response, &status, nullptr);
    context.TryCancel();
    void* tag = nullptr;
    bool is_ok = false;
    ASSERT_TRUE(queue.Next(&tag, &is_ok));
    EXPECT_FALSE(status.ok());
  }
  queue.Shutdown();
  const Pusher pusher(*this);
  EXPECT_THAT(Next(), IsOk());
}

TEST(PushSensor, ListensOnThisMachineUnlessAllowed) {
  EXPECT_THAT(PushSensor::Listen("0.0.0.0:0", /*allow_remote=*/false, {}),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("?allow-remote")));
  const auto remote = PushSensor::Listen("0.0.0.0:0", /*allow_remote=*/true, {});
  ASSERT_THAT(remote, IsOk());
  const std::string port = (*remote)->address().substr((*remote)->address().rfind(':') + 1);
  EXPECT_THAT(PushSensor::Listen(port, /*allow_remote=*/false, {}),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("in use")));
  for (const char* where : {"", "a", "70000", "127.0.0.1:", "-1"}) {
    EXPECT_THAT(PushSensor::Listen(where, /*allow_remote=*/false, {}),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("push:7110")))
        << where;
  }
}

}  // namespace
}  // namespace graspdb::client
