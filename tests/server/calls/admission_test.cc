#include "server/calls/admission.h"

#include <gmock/gmock.h>

#include <atomic>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "tests/testing/status_matchers.h"

namespace graspdb::server {
namespace {

using testing::IsOk;
using testing::StatusIs;

constexpr auto kNever = [] { return false; };
constexpr auto kAlways = [] { return true; };

TEST(Admission, AdmitsOneCallerPerSlot) {
  Admission admission(2, 0);
  const auto first = admission.Enter(kNever);
  const auto second = admission.Enter(kNever);
  EXPECT_THAT(first, IsOk());
  EXPECT_THAT(second, IsOk());
  EXPECT_THAT(admission.Enter(kNever), StatusIs(absl::StatusCode::kResourceExhausted));
}

TEST(Admission, DestroyedTicketReleasesItsSlot) {
  Admission admission(1, 0);
  for (int i = 0; i < 3; ++i) EXPECT_THAT(admission.Enter(kNever), IsOk());
}

TEST(Admission, MovedTicketReleasesItsSlotOnce) {
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

TEST(Admission, CancelledCallerGetsNoSlot) {
  Admission admission(1, 0);
  EXPECT_THAT(admission.Enter(kAlways), StatusIs(absl::StatusCode::kCancelled));
  EXPECT_THAT(admission.Enter(kNever), IsOk());
}

// Callers that wait in a queue for the only slot, which the rig has.
class WaitingCallersTest : public ::testing::Test {
 protected:
  ~WaitingCallersTest() override {
    for (std::thread& caller : callers_) caller.join();
  }

  // Returns when the caller waits; once it has a slot it adds itself to `order_` and ends.
  void LetWait(int number, const std::atomic<bool>& has_left) {
    std::atomic<bool> waits = false;
    callers_.emplace_back([this, number, &waits, &has_left] {
      bool has_waited = false;
      const auto entered = admission_.Enter([&] {
        if (!std::exchange(has_waited, true)) waits = true;
        return has_left.load();
      });
      const std::lock_guard lock(mutex_);
      if (entered.ok()) order_.push_back(number);
    });
    while (!waits) std::this_thread::yield();
  }

  void EnterMyself(int number) {
    const auto entered = admission_.Enter(kNever);
    ASSERT_THAT(entered, IsOk());
    const std::lock_guard lock(mutex_);
    order_.push_back(number);
  }

  // The order of the callers, after all have ended.
  std::vector<int> Order() {
    for (std::thread& caller : callers_) caller.join();
    callers_.clear();
    return order_;
  }

  Admission admission_{1, 16};
  std::optional<absl::StatusOr<Admission::Ticket>> working_{admission_.Enter(kNever)};
  const std::atomic<bool> stays_ = false;
  std::atomic<bool> leaves_ = false;
  std::mutex mutex_;
  std::vector<int> order_;
  std::vector<std::thread> callers_;
};

TEST_F(WaitingCallersTest, AreAdmittedInOrder) {
  for (int i = 0; i < 8; ++i) LetWait(i, stays_);
  working_.reset();
  EXPECT_THAT(Order(), ::testing::ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
}

TEST_F(WaitingCallersTest, AreNotOvertakenByANewCaller) {
  LetWait(0, stays_);
  working_.reset();
  EnterMyself(1);
  EXPECT_THAT(Order(), ::testing::ElementsAre(0, 1));
}

TEST_F(WaitingCallersTest, AreSkippedWhenCancelled) {
  LetWait(0, leaves_);
  LetWait(1, stays_);
  leaves_ = true;
  working_.reset();
  EnterMyself(2);
  EXPECT_THAT(Order(), ::testing::ElementsAre(1, 2));
}

TEST(Admission, CancelledWaiterReleasesItsPlace) {
  Admission admission(1, 1);
  const auto working = admission.Enter(kNever);
  ASSERT_THAT(working, IsOk());
  EXPECT_THAT(admission.Enter(kAlways), StatusIs(absl::StatusCode::kCancelled));
  EXPECT_THAT(admission.Enter(kAlways), StatusIs(absl::StatusCode::kCancelled));
}

TEST(Admission, WaitingCallersAreLimited) {
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

TEST(Admission, EveryWaitingCallerIsAdmitted) {
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
