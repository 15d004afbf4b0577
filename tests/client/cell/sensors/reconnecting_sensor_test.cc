// A camera that is unplugged and reconnected.
#include "client/cell/sensors/reconnecting_sensor.h"

#include <gmock/gmock.h>

#include <atomic>
#include <thread>
#include <vector>

#include "absl/synchronization/mutex.h"
#include "absl/time/clock.h"
#include "tests/client/cell/sensors/scripted_camera.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using testing::IsOk;
using testing::StatusIs;

constexpr absl::Duration kTimeout = absl::Seconds(30);
constexpr absl::Duration kMoment = absl::Milliseconds(2);

MonotonicTime Soon() { return MonotonicTime::Now() + kTimeout; }

// A reconnecting sensor on a cable, optionally with a thread that exposes frames continuously.
class Rig {
 public:
  explicit Rig(bool plugged, absl::Duration watch = kMoment)
      : cable_(CableThatIs(plugged)),
        sensor_("camera no. 0", [cable = cable_] { return ScriptedCamera::Open(cable); },
                {.first_pause = kMoment, .max_pause = 4 * kMoment, .watch = watch}) {}
  ~Rig() { StopFrames(); }

  void StartFrames() {
    exposing_ = true;
    thread_ = std::thread([this] {
      for (int i = 0; exposing_; ++i) {
        cable_->Expose(NumberedFrame(i));
        absl::SleepFor(absl::Milliseconds(1));
      }
    });
  }
  void StopFrames() {
    exposing_ = false;
    if (thread_.joinable()) thread_.join();
  }
  // Whether `happens` within kTimeout.
  template <typename Condition>
  static bool Eventually(const Condition& happens) {
    const MonotonicTime end = Soon();
    while (!happens() && MonotonicTime::Now() < end) absl::SleepFor(absl::Milliseconds(1));
    return happens();
  }

  Cable& cable() { return *cable_; }
  ReconnectingSensor& sensor() { return sensor_; }

 private:
  static std::shared_ptr<Cable> CableThatIs(bool plugged) {
    auto cable = std::make_shared<Cable>();
    cable->plugged = plugged;
    return cable;
  }

  const std::shared_ptr<Cable> cable_;
  ReconnectingSensor sensor_;
  std::atomic<bool> exposing_ = false;
  std::thread thread_;
};

TEST(ReconnectingSensor, ReturnsFramesOfAConnectedCamera) {
  Rig rig(true);
  rig.StartFrames();
  ASSERT_TRUE(Rig::Eventually([&] { return rig.sensor().IsReady(); }));
  EXPECT_THAT(rig.sensor().Next(Soon()), IsOk());
  EXPECT_EQ(rig.sensor().Name(), "scripted camera");
}

TEST(ReconnectingSensor, WithoutACameraTheErrorIsImmediate) {
  Rig rig(false);
  // Far in the future: the call must not wait for it.
  EXPECT_THAT(rig.sensor().Next(MonotonicTime::InfiniteFuture()),
              StatusIs(absl::StatusCode::kUnavailable, "nothing is plugged in"));
  EXPECT_FALSE(rig.sensor().IsReady());
  EXPECT_EQ(rig.sensor().Name(), "camera no. 0");
}

TEST(ReconnectingSensor, OpensACameraThatIsConnectedLater) {
  Rig rig(false);
  EXPECT_THAT(rig.sensor().Next(Soon()), StatusIs(absl::StatusCode::kUnavailable));
  rig.cable().Plug(true);
  rig.StartFrames();
  EXPECT_TRUE(Rig::Eventually([&] { return rig.sensor().Next(Soon()).ok(); }));
}

TEST(ReconnectingSensor, ReconnectsAfterUnpluggingDuringNext) {
  Rig rig(true, /*watch=*/absl::Hours(1));
  ASSERT_TRUE(Rig::Eventually([&] { return rig.sensor().IsReady(); }));
  std::thread hand([&] {
    absl::SleepFor(kMoment);
    rig.cable().Plug(false);
  });
  EXPECT_THAT(rig.sensor().Next(Soon()), StatusIs(absl::StatusCode::kUnavailable, "pulled out"));
  hand.join();
  EXPECT_THAT(rig.sensor().Next(Soon()), StatusIs(absl::StatusCode::kUnavailable));
  EXPECT_FALSE(rig.sensor().IsReady());
  rig.cable().Plug(true);
  rig.StartFrames();
  EXPECT_TRUE(Rig::Eventually([&] { return rig.sensor().Next(Soon()).ok(); }));
  EXPECT_GE(rig.cable().Opened(), 2);
}

TEST(ReconnectingSensor, DetectsALossWhileIdle) {
  Rig rig(true);
  ASSERT_TRUE(Rig::Eventually([&] { return rig.sensor().IsReady(); }));
  const int before = rig.cable().Opened();
  rig.cable().Plug(false);
  rig.cable().Plug(true);
  EXPECT_TRUE(Rig::Eventually([&] { return rig.cable().Opened() > before; }));
}

TEST(ReconnectingSensor, ADeadlineDoesNotReconnect) {
  Rig rig(true);
  ASSERT_TRUE(Rig::Eventually([&] { return rig.sensor().IsReady(); }));
  EXPECT_THAT(rig.sensor().Next(MonotonicTime::Now() + kMoment),
              StatusIs(absl::StatusCode::kDeadlineExceeded));
  EXPECT_TRUE(rig.sensor().IsReady());
  rig.StartFrames();
  EXPECT_THAT(rig.sensor().Next(Soon()), IsOk());
  EXPECT_EQ(rig.cable().Opened(), 1);
}

TEST(ReconnectingSensor, NeverHasTwoSensorsAtOnceUnderLoad) {
  Rig rig(true);
  rig.StartFrames();
  std::atomic<int> frames = 0;
  std::atomic<bool> running = true;
  std::vector<std::thread> callers;
  callers.reserve(4);
  for (int i = 0; i < 4; ++i) {
    callers.emplace_back([&] {
      while (running) frames += rig.sensor().Next(Soon()).ok() ? 1 : 0;
    });
  }
  for (int shake = 0; shake < 20; ++shake) {
    rig.cable().Plug(false);
    absl::SleepFor(kMoment);
    rig.cable().Plug(true);
    absl::SleepFor(kMoment);
  }
  const int so_far = frames;
  EXPECT_TRUE(Rig::Eventually([&] { return frames > so_far; }));
  running = false;
  for (std::thread& caller : callers) caller.join();
  EXPECT_EQ(rig.cable().max_open, 1);
}

TEST(ReconnectingSensor, WaitsForAnAttemptInProgress) {
  absl::Mutex mutex;
  bool may_open = false;
  const auto cable = std::make_shared<Cable>();
  cable->Plug(true);
  ReconnectingSensor sensor("slow",
                            [&] {
                              const absl::MutexLock lock(&mutex);
                              while (!may_open)
                                mutex.AwaitWithTimeout(absl::Condition(&may_open), kTimeout);
                              return ScriptedCamera::Open(cable);
                            },
                            {.first_pause = kMoment, .max_pause = kMoment, .watch = kMoment});
  EXPECT_THAT(sensor.Next(MonotonicTime::Now() + kMoment),
              StatusIs(absl::StatusCode::kUnavailable, ::testing::HasSubstr("being opened")));
  std::thread opener([&] {
    const absl::MutexLock lock(&mutex);
    may_open = true;
  });
  // The camera is connected but has no frame: only a call that waited for it returns this error.
  EXPECT_TRUE(Rig::Eventually([&] {
    return absl::IsDeadlineExceeded(sensor.Next(MonotonicTime::Now() + 20 * kMoment).status());
  }));
  opener.join();
}

}  // namespace
}  // namespace graspdb::client
