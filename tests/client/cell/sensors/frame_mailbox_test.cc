// Frames between a camera's thread and waiting threads.
#include "client/cell/sensors/frame_mailbox.h"

#include <gmock/gmock.h>

#include <thread>

#include "absl/time/clock.h"
#include "client/cell/sensors/depth_sensor.h"
#include "tests/client/cell/sensors/scripted_camera.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::StatusIs;

constexpr absl::Duration kLong = absl::Seconds(60);
const MonotonicTime then = MonotonicTime::Now();

TEST(FrameMailbox, SkipsFramesFromBeforeTheCall) {
  FrameMailbox box(kLong);
  box.Put(NumberedFrame(1, then));
  EXPECT_THAT(box.Wait(then + absl::Nanoseconds(1), MonotonicTime::Now()),
              StatusIs(absl::StatusCode::kDeadlineExceeded));
  const auto frame = box.Wait(then, MonotonicTime::Now());
  ASSERT_THAT(frame, IsOk());
  EXPECT_EQ(DataOf(*frame), "1");
}

TEST(FrameMailbox, KeepsOnlyTheNewestFrame) {
  FrameMailbox box(kLong);
  box.Put(NumberedFrame(1, then));
  box.Put(NumberedFrame(2, then));
  EXPECT_EQ(DataOf(*box.Wait(then, MonotonicTime::Now())), "2");
}

TEST(FrameMailbox, AFrameWakesWaiters) {
  FrameMailbox box(kLong);
  std::thread camera([&box] { box.Put(NumberedFrame(7, then)); });
  const auto frame = box.Wait(then, MonotonicTime::Now() + kLong);
  camera.join();
  ASSERT_THAT(frame, IsOk());
  EXPECT_EQ(DataOf(*frame), "7");
}

TEST(FrameMailbox, AFailureWakesWaitersAndStays) {
  FrameMailbox box(kLong);
  std::thread camera([&box] { box.Fail(absl::UnavailableError("pulled out")); });
  EXPECT_THAT(box.Wait(then, MonotonicTime::Now() + kLong),
              StatusIs(absl::StatusCode::kUnavailable, "pulled out"));
  camera.join();
  box.Fail(absl::InternalError("a later reason"));
  EXPECT_THAT(box.Wait(then, MonotonicTime::Now()), StatusIs(absl::StatusCode::kUnavailable));
  EXPECT_FALSE(box.IsAlive());
}

TEST(FrameMailbox, ASilentCameraIsUnavailable) {
  FrameMailbox box(absl::Milliseconds(5));
  EXPECT_THAT(
      box.Wait(MonotonicTime::Now(), MonotonicTime::Now() + kLong),
      StatusIs(absl::StatusCode::kUnavailable, HasSubstr("no frame from the camera for 5ms")));
  EXPECT_FALSE(box.IsAlive());
  box.Put(NumberedFrame(1));
  EXPECT_THAT(box.Wait(then, MonotonicTime::Now() + kLong), IsOk());
}

// Returns one frame of a given age.
class Aged : public DepthSensor {
 public:
  explicit Aged(absl::Duration age) : age_(age) {}
  absl::StatusOr<SensorFrame> Next(MonotonicTime /*deadline*/) override {
    return NumberedFrame(1, MonotonicTime::Now() - age_);
  }
  bool IsReady() override { return true; }
  std::string Name() const override { return "aged"; }

 private:
  const absl::Duration age_;
};

TEST(FreshSensor, AnOldFrameIsAnError) {
  FreshSensor young(std::make_unique<Aged>(absl::ZeroDuration()), absl::Minutes(1));
  EXPECT_THAT(young.Next(MonotonicTime::InfiniteFuture()), IsOk());
  FreshSensor old(std::make_unique<Aged>(absl::Minutes(2)), absl::Minutes(1));
  EXPECT_THAT(old.Next(MonotonicTime::InfiniteFuture()),
              StatusIs(absl::StatusCode::kUnavailable, HasSubstr("the limit is 1m")));
}

TEST(SetTime, TheScansCaptureTimeIsTheMomentByTheWallClock) {
  constexpr absl::Duration kMargin = absl::Milliseconds(1);  // between the clocks
  SensorFrame frame = NumberedFrame(1);
  const absl::Time before = absl::Now() - kLong;
  const MonotonicTime time = MonotonicTime::Now() - kLong;
  SetTime(time, frame);
  const absl::Time after = absl::Now() - kLong;
  EXPECT_EQ(frame.time, time);
  const auto& stamp = std::get<v1::DepthImage>(frame.scan).capture_time();
  const absl::Time shown =
      absl::FromUnixSeconds(stamp.seconds()) + absl::Nanoseconds(stamp.nanos());
  EXPECT_GE(shown, before - kMargin);
  EXPECT_LE(shown, after + kMargin);
}

}  // namespace
}  // namespace graspdb::client
