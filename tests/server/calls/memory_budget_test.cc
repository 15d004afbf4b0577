#include "server/calls/memory_budget.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "google/rpc/error_details.pb.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::server {
namespace {

using ::graspdb::testing::IsOk;
using ::graspdb::testing::StatusIs;

constexpr std::size_t kMebi = std::size_t{1} << 20U;

TEST(ShareMemoryTest, HalfIsForCachesAndAQuarterForRequests) {
  const MemoryShares shares = ShareMemory(1000, 0);
  EXPECT_EQ(shares.total, 1000 * kMebi);
  EXPECT_EQ(shares.caches, 500 * kMebi);
  EXPECT_EQ(shares.requests, 250 * kMebi);
  EXPECT_EQ(ShareMemory(1000, 64).caches, 64 * kMebi);
}

TEST(ShareMemoryTest, DefaultIsAShareOfTheMachine) {
  const MemoryShares shares = ShareMemory(0, 0);
  EXPECT_GT(shares.total, 64 * kMebi);
  EXPECT_EQ(shares.caches, shares.total / 2);
}

TEST(RequestMemoryTest, RequestBeyondTheBudgetIsRejectedUntilMemoryIsFree) {
  RequestMemory memory(160);
  {
    const auto first = memory.Reserve(80);
    ASSERT_THAT(first, IsOk());
    const auto second = memory.Reserve(41);
    EXPECT_THAT(second, StatusIs(absl::StatusCode::kResourceExhausted));
    EXPECT_TRUE(second.status().GetPayload("type.googleapis.com/google.rpc.RetryInfo"));
    EXPECT_THAT(memory.Reserve(40), IsOk());
    EXPECT_EQ(memory.use().bytes, 80U);
    EXPECT_EQ(memory.use().refused, 1);
  }
  EXPECT_EQ(memory.use().bytes, 0U);
  EXPECT_THAT(memory.Reserve(120), IsOk());
}

TEST(RequestMemoryTest, OversizedRequestsAreAdmittedOneAtATime) {
  RequestMemory memory(160);
  {
    const auto large = memory.Reserve(1000);
    ASSERT_THAT(large, IsOk());
    EXPECT_THAT(memory.Reserve(1000), StatusIs(absl::StatusCode::kResourceExhausted));
    EXPECT_THAT(memory.Reserve(11), StatusIs(absl::StatusCode::kResourceExhausted));
  }
  EXPECT_THAT(memory.Reserve(1000), IsOk());
}

TEST(RequestMemoryTest, SmallAndLargeOnesTogetherStayWithinTheBudget) {
  RequestMemory memory(160);
  std::vector<RequestMemory::Reservation> all;
  for (const std::size_t bytes : {10U, 120U}) {
    while (true) {
      auto next = memory.Reserve(bytes);
      if (!next.ok()) break;
      all.push_back(*std::move(next));
    }
  }
  EXPECT_EQ(memory.use().bytes, 160U);
}

TEST(RequestMemoryTest, LargeRequestsLeaveMemoryForSmallOnes) {
  for (const std::size_t large_bytes : {120U, 1000U}) {
    RequestMemory memory(160);
    const auto large = memory.Reserve(large_bytes);
    ASSERT_THAT(large, IsOk());
    std::vector<RequestMemory::Reservation> small;
    for (int i = 0; i < 4; ++i) {
      auto next = memory.Reserve(10);
      ASSERT_THAT(next, IsOk());
      small.push_back(*std::move(next));
    }
    EXPECT_THAT(memory.Reserve(10), StatusIs(absl::StatusCode::kResourceExhausted));
  }
}

}  // namespace
}  // namespace graspdb::server
