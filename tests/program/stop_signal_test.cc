#include "program/stop_signal.h"

#include <gtest/gtest.h>

#include <csignal>

namespace graspdb {
namespace {

TEST(StopSignal, IsPendingUntilItIsWaitedFor) {
  sigset_t before;
  ASSERT_EQ(pthread_sigmask(SIG_BLOCK, nullptr, &before), 0);
  {
    const StopSignal stop;
    for (const int signal : {SIGTERM, SIGINT}) {
      EXPECT_FALSE(stop.IsPending());
      ASSERT_EQ(raise(signal), 0);
      EXPECT_TRUE(stop.IsPending());
      EXPECT_EQ(stop.Wait(), signal);
    }
    EXPECT_FALSE(stop.IsPending());
  }
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

}  // namespace
}  // namespace graspdb
