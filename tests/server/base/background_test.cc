#include "server/base/background.h"

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <stdexcept>
#include <thread>

#include "tests/testing/status_matchers.h"

namespace graspdb::server {
namespace {

using graspdb::testing::IsOk;
using graspdb::testing::StatusIs;

int Niceness() { return getpriority(PRIO_PROCESS, static_cast<id_t>(gettid())); }

TEST(BackgroundTest, WorkHasLowerPriorityThanItsCaller) {
  static constexpr int kNicest = 19;
  for (int caller = Niceness(); caller <= kNicest; ++caller) {
    std::thread([caller] {
      ASSERT_EQ(setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), caller), 0);
      int inside = -1;
      EXPECT_THAT(InBackground([&] {
                    inside = Niceness();
                    return absl::OkStatus();
                  }),
                  IsOk());
      EXPECT_EQ(inside, std::min(caller + 10, kNicest));
      EXPECT_EQ(Niceness(), caller);
    }).join();
  }
}

TEST(BackgroundTest, ErrorsAreReturned) {
  EXPECT_THAT(InBackground([] { return absl::AbortedError("again"); }),
              StatusIs(absl::StatusCode::kAborted));
}

TEST(BackgroundTest, ExceptionsReachTheCaller) {
  const auto work = []() -> absl::Status { throw std::runtime_error("of a library"); };
  EXPECT_THROW((void)InBackground(work), std::runtime_error);
}

}  // namespace
}  // namespace graspdb::server
