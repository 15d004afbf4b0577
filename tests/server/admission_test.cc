#include "server/admission.h"

#include <gmock/gmock.h>

#include <atomic>
#include <optional>
#include <thread>
#include <vector>

#include "tests/testing/status_matchers.h"

namespace graspdb::server {
namespace {

using testing::IsOk;
using testing::StatusIs;

constexpr auto kNever = [] { return false; };
constexpr auto kAlways = [] { return true; };

TEST(Admission, LetsAsManyWorkAsThereAreSlots) {
  Admission admission(2, 0);
  const auto first = admission.Enter(kNever);
  const auto second = admission.Enter(kNever);
  EXPECT_THAT(first, IsOk());
  EXPECT_THAT(second, IsOk());
  EXPECT_THAT(admission.Enter(kNever), StatusIs(absl::StatusCode::kResourceExhausted));
}

TEST(Admission, ATicketThatGoesGivesItsSlotBack) {
  Admission admission(1, 0);
  for (int i = 0; i < 3; ++i) EXPECT_THAT(admission.Enter(kNever), IsOk());
}

TEST(Admission, AMovedTicketGivesItsSlotBackOnce) {
  Admission admission(1, 0);
  {
    auto entered = admission.Enter(kNever);
    ASSERT_THAT(entered, IsOk());
    const Admission::Ticket moved = *std::move(entered);
    EXPECT_THAT(admission.Enter(kNever), StatusIs(absl::StatusCode::kResourceExhausted));
  }
  const auto again = admission.Enter(kNever);
  EXPECT_THAT(again, IsOk());
  EXPECT_THAT(admission.Enter(kNever), StatusIs(absl::StatusCode::kResourceExhausted));
}

TEST(Admission, AFreeSlotIsTakenWithoutAskingTheCaller) {
  Admission admission(1, 0);
  EXPECT_THAT(admission.Enter(kAlways), IsOk());
}

TEST(Admission, WhoeverIsCancelledWhileWaitingGivesThePlaceBack) {
  Admission admission(1, 1);
  const auto working = admission.Enter(kNever);
  ASSERT_THAT(working, IsOk());
  EXPECT_THAT(admission.Enter(kAlways), StatusIs(absl::StatusCode::kCancelled));
  EXPECT_THAT(admission.Enter(kAlways), StatusIs(absl::StatusCode::kCancelled));
}

TEST(Admission, OnlySoManyMayWait) {
  Admission admission(1, 1);
  auto working = std::optional(admission.Enter(kNever));
  std::atomic<bool> waits = false;
  std::thread waiter([&] {
    const auto entered = admission.Enter([&] {
      waits = true;
      return false;
    });
    EXPECT_THAT(entered, IsOk());
  });
  while (!waits) std::this_thread::yield();
  EXPECT_THAT(admission.Enter(kNever), StatusIs(absl::StatusCode::kResourceExhausted));
  working.reset();
  waiter.join();
}

TEST(Admission, EveryWaitingCallerHasItsTurn) {
  constexpr int kSlots = 2;
  constexpr int kCallers = 16;
  Admission admission(kSlots, kCallers);
  std::atomic<int> working = 0;
  std::atomic<int> most = 0;
  std::atomic<int> done = 0;
  std::vector<std::thread> callers;
  callers.reserve(kCallers);
  for (int i = 0; i < kCallers; ++i) {
    callers.emplace_back([&] {
      const auto ticket = admission.Enter(kNever);
      ASSERT_THAT(ticket, IsOk());
      const int now = ++working;
      int before = most;
      while (before < now && !most.compare_exchange_weak(before, now)) {
      }
      std::this_thread::yield();
      --working;
      ++done;
    });
  }
  for (std::thread& caller : callers) caller.join();
  EXPECT_EQ(done, kCallers);
  EXPECT_LE(most, kSlots);
}

}  // namespace
}  // namespace graspdb::server
