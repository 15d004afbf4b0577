// Times and waits that do not follow the wall clock.
#include "program/base/monotonic_time.h"

#include <gmock/gmock.h>

#include <thread>

#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "program/base/monotonic_cond_var.h"

namespace graspdb {
namespace {

TEST(MonotonicTimeTest, CountsDurations) {
  const MonotonicTime now = MonotonicTime::Now();
  EXPECT_EQ(now + absl::Seconds(3) - now, absl::Seconds(3));
  EXPECT_EQ(now - absl::Seconds(3) - now, -absl::Seconds(3));
  EXPECT_LT(now - absl::Nanoseconds(1), now);
  EXPECT_GT(now + absl::Nanoseconds(1), now);
  EXPECT_NE(now + absl::Nanoseconds(1), now);
  EXPECT_LE(now, MonotonicTime::Now());
}

TEST(MonotonicTimeTest, InfiniteTimesStayInfinite) {
  const MonotonicTime now = MonotonicTime::Now();
  EXPECT_EQ(now + absl::InfiniteDuration(), MonotonicTime::InfiniteFuture());
  EXPECT_EQ(now - absl::InfiniteDuration(), MonotonicTime::InfinitePast());
  EXPECT_EQ(MonotonicTime::InfiniteFuture() - now, absl::InfiniteDuration());
  EXPECT_EQ(MonotonicTime::InfinitePast() - now, -absl::InfiniteDuration());
  EXPECT_GT(MonotonicTime::InfiniteFuture().ToChrono(), now.ToChrono());
  EXPECT_LT(MonotonicTime::InfinitePast().ToChrono(), now.ToChrono());
}

TEST(MonotonicCondVarTest, AWaitEndsAtItsDeadline) {
  absl::Mutex mutex;
  MonotonicCondVar changed;
  const MonotonicTime deadline = MonotonicTime::Now() + absl::Milliseconds(5);
  const absl::MutexLock lock(&mutex);
  bool has_passed = false;
  while (!has_passed) has_passed = changed.WaitUntil(&mutex, deadline);
  EXPECT_GE(MonotonicTime::Now(), deadline);
}

TEST(MonotonicCondVarTest, ASignalEndsWaitsThatWouldNotEnd) {
  absl::Mutex mutex;
  MonotonicCondVar changed;
  int turn = 0;
  std::thread other([&] {
    const absl::MutexLock lock(&mutex);
    turn = 1;
    changed.SignalAll();
    while (turn == 1) changed.Wait(&mutex);
    turn = 3;
    changed.SignalAll();
  });
  {
    const absl::MutexLock lock(&mutex);
    while (turn != 1) changed.WaitUntil(&mutex, MonotonicTime::InfiniteFuture());
    turn = 2;
    changed.SignalAll();
    while (turn == 2) changed.Wait(&mutex);
    EXPECT_EQ(turn, 3);
  }
  other.join();
}

}  // namespace
}  // namespace graspdb
