#include "client/cell/agent/jobs/capture_and_recognize.h"

#include <gmock/gmock.h>

#include <memory>
#include <string>
#include <variant>

#include "absl/synchronization/notification.h"
#include "absl/time/clock.h"
#include "client/cell/sensors/depth_sensor.h"
#include "files/messages/pose_message.h"
#include "tests/client/cell/agent/fake_camera.h"
#include "tests/client/cell/agent/scripted_server.h"
#include "tests/testing/busy_status.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using graspdb::testing::IsOk;
using graspdb::testing::StatusIs;
using recognition::Pose;
using ::testing::HasSubstr;

SensorFrame FrameNow() {
  v1::DepthImage image;
  image.mutable_intrinsics()->set_width(640);
  return {.scan = image, .time = MonotonicTime::Now(), .world_sensor = {}};
}

Pose AtX(double x) { return Pose(Eigen::Translation3d(x, 0, 0)); }

class CaptureAndRecognizeTest : public ::testing::Test {
 protected:
  CaptureAndRecognizeTest() {
    server_.get_cell = [](v1::Cell* cell) {
      *cell->mutable_sensor_pose() = files::ToMessage(AtX(0.5));
      return grpc::Status::OK;
    };
    server_.recognize = [this](const v1::RecognizeRequest& request, v1::RecognizeResponse* answer) {
      ++calls_;
      *answer->mutable_sensor_pose() = request.sensor_pose();
      answer->set_catalog_revision(request.depth_image().intrinsics().width());
      return calls_ <= failures_ ? refusal_ : grpc::Status::OK;
    };
  }

  absl::StatusOr<CaptureResult> Run(absl::Duration limit = absl::Seconds(60)) {
    CellCache cache(client_, "cells/press-3", absl::Hours(1));
    cache.Refresh().IgnoreError();  // on a slow machine it would take the limit's time
    CaptureAndRecognize capture_and_recognize(sensor_, client_, cache, "cells/press-3");
    CaptureResult capture;
    absl::Status status =
        capture_and_recognize.Run(base_flange_, MonotonicTime::Now() + limit, &capture);
    if (!status.ok()) return status;
    return capture;
  }

  ScriptedServer server_;
  Client client_ = server_.Connect();
  std::function<absl::StatusOr<SensorFrame>()> give_ = [] { return FrameNow(); };
  int given_ = 0;
  FreshSensor sensor_{std::make_unique<FakeCamera>([this] {
                        ++given_;
                        return give_();
                      }),
                      absl::Seconds(1)};
  std::optional<Pose> base_flange_;
  int calls_ = 0;
  int failures_ = 0;
  grpc::Status refusal_;
};

TEST_F(CaptureAndRecognizeTest, SendsTheFrameWithTheCellsCalibration) {
  const auto capture = Run();
  ASSERT_THAT(capture, IsOk());
  EXPECT_EQ(capture->request.cell(), "cells/press-3");
  EXPECT_EQ(capture->response.catalog_revision(), 640);
  EXPECT_TRUE(files::FromMessage(capture->response.sensor_pose()).isApprox(AtX(0.5)));
}

TEST_F(CaptureAndRecognizeTest, AFlangeCameraUsesTheRobotsPose) {
  server_.get_cell = [](v1::Cell* cell) {
    *cell->mutable_robot_base_pose() = files::ToMessage(AtX(-1));
    *cell->mutable_flange_sensor_pose() = files::ToMessage(AtX(0.1));
    return grpc::Status::OK;
  };
  EXPECT_THAT(Run(), StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("flange")));
  base_flange_ = AtX(0.7);
  const auto capture = Run();
  ASSERT_THAT(capture, IsOk());
  EXPECT_TRUE(files::FromMessage(capture->request.sensor_pose()).isApprox(AtX(-0.2)));
}

TEST_F(CaptureAndRecognizeTest, UncalibratedAndMissingCellsAreReported) {
  server_.get_cell = [](v1::Cell*) { return grpc::Status::OK; };
  EXPECT_THAT(Run(), StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("cells level")));
  server_.get_cell = [](v1::Cell*) { return grpc::Status(grpc::StatusCode::NOT_FOUND, "none"); };
  EXPECT_THAT(Run(), StatusIs(absl::StatusCode::kFailedPrecondition,
                              HasSubstr("graspdb cells set press-3")));
}

TEST_F(CaptureAndRecognizeTest, AFaultOfTheCameraIsNoFaultOfTheRequest) {
  for (const auto code : {absl::StatusCode::kInvalidArgument, absl::StatusCode::kNotFound,
                          absl::StatusCode::kFailedPrecondition}) {
    given_ = 0;
    give_ = [code] { return absl::Status(code, "scan.pcd is damaged"); };
    EXPECT_THAT(Run(), StatusIs(absl::StatusCode::kAborted, HasSubstr("damaged")));
    EXPECT_EQ(given_, 1) << "a damaged file stays damaged";
  }
}

// As of a covered camera: the server would reject it, as if the robot's request were wrong.
TEST_F(CaptureAndRecognizeTest, AFrameWithoutAnyDepthIsAFaultOfTheCamera) {
  std::string depths(20, '\0');
  give_ = [&depths]() -> absl::StatusOr<SensorFrame> {
    SensorFrame frame = FrameNow();
    std::get<v1::DepthImage>(frame.scan).set_data(depths);
    return frame;
  };
  EXPECT_THAT(Run(), StatusIs(absl::StatusCode::kAborted, HasSubstr("covered")));
  EXPECT_EQ(calls_, 0);
  depths[11] = 3;
  EXPECT_THAT(Run(), IsOk());
}

TEST_F(CaptureAndRecognizeTest, RetriesAServerThatIsUnavailableForAMoment) {
  failures_ = 2;
  refusal_ = {grpc::StatusCode::UNAVAILABLE, "restarting"};
  ASSERT_THAT(Run(), IsOk());
  EXPECT_EQ(calls_, 3);
}

TEST_F(CaptureAndRecognizeTest, RetriesABusyServerWithANewFrame) {
  failures_ = 2;
  refusal_ = testing::BusyFor(absl::Milliseconds(1));
  ASSERT_THAT(Run(), IsOk());
  EXPECT_EQ(calls_, 3);
  EXPECT_EQ(given_, 3);
}

TEST_F(CaptureAndRecognizeTest, WaitsAsLongAsABusyServerRequires) {
  failures_ = 1000000;
  refusal_ = testing::BusyFor(absl::Seconds(20));
  EXPECT_THAT(Run(absl::Seconds(15)),
              StatusIs(absl::StatusCode::kUnavailable, "the queue is full"));
  EXPECT_EQ(calls_, 1);
}

TEST_F(CaptureAndRecognizeTest, AFrameThatIsTooLargeIsNotRetried) {
  failures_ = 1000000;
  refusal_ = {grpc::StatusCode::RESOURCE_EXHAUSTED, "message is too large"};
  EXPECT_THAT(Run(), StatusIs(absl::StatusCode::kDataLoss, HasSubstr("too large")));
  EXPECT_EQ(calls_, 1);
}

TEST_F(CaptureAndRecognizeTest, WithoutAServerTheJobEndsAtItsDeadline) {
  failures_ = 1000000;
  refusal_ = {grpc::StatusCode::UNAVAILABLE, "gone"};
  EXPECT_THAT(Run(absl::Seconds(2)), StatusIs(absl::StatusCode::kUnavailable));
}

TEST_F(CaptureAndRecognizeTest, ALastCallWithoutTimeKeepsTheUnavailableError) {
  const MonotonicTime deadline = MonotonicTime::Now() + absl::Seconds(2);
  server_.recognize = [this, deadline](const v1::RecognizeRequest&, v1::RecognizeResponse*) {
    if (++calls_ > 1) absl::SleepFor(deadline + absl::Milliseconds(100) - MonotonicTime::Now());
    return grpc::Status(grpc::StatusCode::UNAVAILABLE, "gone");
  };
  EXPECT_THAT(Run(deadline - MonotonicTime::Now()),
              StatusIs(absl::StatusCode::kUnavailable, HasSubstr("gone")));
}

TEST_F(CaptureAndRecognizeTest, TheCellIsReadWithinTheJobsOwnTime) {
  const auto ended = std::make_shared<absl::Notification>();  // calls may outlive this test
  server_.get_cell = [ended](v1::Cell*) {
    ended->WaitForNotification();
    return grpc::Status::OK;
  };
  Client client = server_.Connect({.timeout = absl::Hours(1), .retry = false});
  CellCache cache(client, "cells/press-3", absl::Hours(1));
  CaptureAndRecognize capture_and_recognize(sensor_, client, cache, "cells/press-3");
  CaptureResult capture;
  EXPECT_THAT(
      capture_and_recognize.Run({}, MonotonicTime::Now() + absl::Milliseconds(100), &capture),
      StatusIs(absl::StatusCode::kUnavailable, HasSubstr("has not been read yet")));
  ended->Notify();
}

TEST_F(CaptureAndRecognizeTest, RejectedRequestsAreNotRetried) {
  failures_ = 1;
  refusal_ = {grpc::StatusCode::INVALID_ARGUMENT, "no frame"};
  EXPECT_THAT(Run(), StatusIs(absl::StatusCode::kDataLoss, HasSubstr("no frame")));
  EXPECT_EQ(calls_, 1);
}

TEST_F(CaptureAndRecognizeTest, RetriesACameraThatIsReconnected) {
  give_ = [this]() -> absl::StatusOr<SensorFrame> {
    if (given_ < 3) return absl::UnavailableError("unplugged");
    return FrameNow();
  };
  ASSERT_THAT(Run(), IsOk());
  EXPECT_EQ(given_, 3);
}

TEST_F(CaptureAndRecognizeTest, AMissingCameraIsNotReportedAsTheServer) {
  give_ = [] { return absl::UnavailableError("unplugged; look at the cable"); };
  EXPECT_THAT(Run(absl::Milliseconds(100)),
              StatusIs(absl::StatusCode::kAborted, HasSubstr("cable")));
  EXPECT_EQ(calls_, 0);
}

TEST_F(CaptureAndRecognizeTest, AMissingServerIsNotReportedAsTheCamera) {
  failures_ = 1000000;
  refusal_ = {grpc::StatusCode::UNAVAILABLE, "gone"};
  const MonotonicTime deadline = MonotonicTime::Now() + absl::Seconds(2);
  give_ = [this, deadline]() -> absl::StatusOr<SensorFrame> {
    if (given_ == 1) return FrameNow();
    absl::SleepFor(deadline - MonotonicTime::Now());
    return absl::DeadlineExceededError("no frame in time");
  };
  EXPECT_THAT(Run(deadline - MonotonicTime::Now()),
              StatusIs(absl::StatusCode::kUnavailable, HasSubstr("gone")));
  EXPECT_EQ(calls_, 1);
}

TEST_F(CaptureAndRecognizeTest, OldFramesAreRejected) {
  give_ = []() -> absl::StatusOr<SensorFrame> {
    SensorFrame frame = FrameNow();
    frame.time = MonotonicTime::Now() - absl::Seconds(3);
    return frame;
  };
  EXPECT_THAT(Run(absl::Milliseconds(100)), StatusIs(absl::StatusCode::kAborted, HasSubstr("old")));
  EXPECT_EQ(calls_, 0);
}

TEST_F(CaptureAndRecognizeTest, StoppingEndsTheWait) {
  failures_ = 1000000;
  refusal_ = {grpc::StatusCode::UNAVAILABLE, "gone"};
  CellCache cache(client_, "cells/press-3", absl::Hours(1));
  CaptureAndRecognize capture_and_recognize(sensor_, client_, cache, "cells/press-3");
  capture_and_recognize.Stop();
  CaptureResult capture;
  EXPECT_THAT(capture_and_recognize.Run({}, MonotonicTime::InfiniteFuture(), &capture),
              StatusIs(absl::StatusCode::kUnavailable));
}

}  // namespace
}  // namespace graspdb::client
