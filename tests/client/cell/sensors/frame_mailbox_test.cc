// Frames between a camera's thread and waiting threads.
#include "client/cell/sensors/frame_mailbox.h"

#include <gmock/gmock.h>

#include <thread>

#include "client/cell/sensors/fresh_sensor.h"
#include "tests/client/cell/sensors/scripted_camera.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::StatusIs;

constexpr absl::Duration kLong = absl::Seconds(60);
const absl::Time then = absl::FromUnixSeconds(1'700'000'000);

TEST(FrameMailbox, SkipsFramesFromBeforeTheCall) {
  FrameMailbox box(kLong);
  box.Put(NumberedFrame(1, then));
  EXPECT_THAT(box.Wait(then + absl::Nanoseconds(1), absl::Now()),
              StatusIs(absl::StatusCode::kDeadlineExceeded));
  const auto frame = box.Wait(then, absl::Now());
  ASSERT_THAT(frame, IsOk());
  EXPECT_EQ(DataOf(*frame), "1");
}

TEST(FrameMailbox, KeepsOnlyTheNewestFrame) {
  FrameMailbox box(kLong);
  box.Put(NumberedFrame(1, then));
  box.Put(NumberedFrame(2, then));
  EXPECT_EQ(DataOf(*box.Wait(then, absl::Now())), "2");
}

TEST(FrameMailbox, AFrameWakesWaiters) {
  FrameMailbox box(kLong);
  std::thread camera([&box] { box.Put(NumberedFrame(7, then)); });
  const auto frame = box.Wait(then, absl::Now() + kLong);
  camera.join();
  ASSERT_THAT(frame, IsOk());
  EXPECT_EQ(DataOf(*frame), "7");
}

TEST(FrameMailbox, AFailureWakesWaitersAndStays) {
  FrameMailbox box(kLong);
  std::thread camera([&box] { box.Fail(absl::UnavailableError("pulled out")); });
  EXPECT_THAT(box.Wait(then, absl::Now() + kLong),
              StatusIs(absl::StatusCode::kUnavailable, "pulled out"));
  camera.join();
  box.Fail(absl::InternalError("a later reason"));
  EXPECT_THAT(box.Wait(then, absl::Now()), StatusIs(absl::StatusCode::kUnavailable));
  EXPECT_FALSE(box.IsAlive());
}

TEST(FrameMailbox, ASilentCameraIsUnavailable) {
  FrameMailbox box(absl::Milliseconds(5));
  EXPECT_THAT(
      box.Wait(absl::Now(), absl::Now() + kLong),
      StatusIs(absl::StatusCode::kUnavailable, HasSubstr("no frame from the camera for 5ms")));
  EXPECT_FALSE(box.IsAlive());
  box.Put(NumberedFrame(1));
  EXPECT_THAT(box.Wait(then, absl::Now() + kLong), IsOk());
}

// Returns one frame of a given age.
class Aged : public DepthSensor {
 public:
  explicit Aged(absl::Duration age) : age_(age) {}
  absl::StatusOr<SensorFrame> Next(absl::Time /*deadline*/) override {
    return NumberedFrame(1, absl::Now() - age_);
  }
  bool IsReady() override { return true; }
  std::string Name() const override { return "aged"; }

 private:
  const absl::Duration age_;
};

TEST(FreshSensor, AnOldFrameIsAnError) {
  FreshSensor young(std::make_unique<Aged>(absl::ZeroDuration()), absl::Minutes(1));
  EXPECT_THAT(young.Next(absl::InfiniteFuture()), IsOk());
  FreshSensor old(std::make_unique<Aged>(absl::Minutes(2)), absl::Minutes(1));
  EXPECT_THAT(old.Next(absl::InfiniteFuture()),
              StatusIs(absl::StatusCode::kUnavailable, HasSubstr("the limit is 1m")));
  FreshSensor ahead(std::make_unique<Aged>(-absl::Minutes(2)), absl::Minutes(1));
  EXPECT_THAT(ahead.Next(absl::InfiniteFuture()),
              StatusIs(absl::StatusCode::kUnavailable, HasSubstr("clock")));
}

TEST(SetTime, SetsTheScansCaptureTime) {
  SensorFrame frame = NumberedFrame(1);
  SetTime(absl::FromUnixSeconds(-2) + absl::Nanoseconds(5), frame);
  const auto& stamp = std::get<v1::DepthImage>(frame.scan).capture_time();
  EXPECT_EQ(stamp.seconds(), -2);
  EXPECT_EQ(stamp.nanos(), 5);
}

}  // namespace
}  // namespace graspdb::client
