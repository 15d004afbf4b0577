#include "recognition/base/idle_cores.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>
#include <vector>

namespace graspdb::recognition {
namespace {

TEST(IdleCoresTest, EachJobRunsOnce) {
  for (const std::size_t count : {0U, 1U, 2U, 1000U}) {
    std::vector<std::atomic<int>> runs(count);
    ForEachIndex(count, [&](std::size_t i) { ++runs[i]; });
    for (const auto& run : runs) EXPECT_EQ(run, 1);
  }
}

TEST(IdleCoresTest, JobsMayBeNested) {
  std::vector<std::atomic<int>> runs(100);
  ForEachIndex(
      10, [&](std::size_t i) { ForEachIndex(10, [&](std::size_t j) { ++runs[10 * i + j]; }); });
  for (const auto& run : runs) EXPECT_EQ(run, 1);
}

TEST(IdleCoresTest, ManyThreadsMayCallItAtOnce) {
  std::atomic<int> runs = 0;
  std::vector<std::thread> threads;
  threads.reserve(8);
  for (int t = 0; t < 8; ++t) {
    threads.emplace_back([&] {
      for (int n = 0; n < 50; ++n) ForEachIndex(7, [&](std::size_t) { ++runs; });
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(runs, 8 * 50 * 7);
}

TEST(IdleCoresTest, AnExceptionIsRethrownWhenAllJobsAreDone) {
  std::atomic<int> runs = 0;
  const auto job = [&](std::size_t i) {
    ++runs;
    if (i == 3) throw std::runtime_error("no room");
  };
  EXPECT_THROW(ForEachIndex(20, job), std::runtime_error);
  EXPECT_EQ(runs, 20);
}

TEST(IdleCoresTest, AnotherThreadHelpsWhereACoreIsIdle) {
  if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "one core";
  // Each of the two jobs waits for the other to begin.
  std::atomic<int> begun = 0;
  ForEachIndex(2, [&](std::size_t) {
    ++begun;
    while (begun < 2) std::this_thread::yield();
  });
  EXPECT_EQ(begun, 2);
}

}  // namespace
}  // namespace graspdb::recognition
