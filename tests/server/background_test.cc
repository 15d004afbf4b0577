#include "server/background.h"

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <unistd.h>

#include <stdexcept>

#include "tests/testing/status_matchers.h"

namespace graspdb::server {
namespace {

using graspdb::testing::IsOk;
using graspdb::testing::StatusIs;

int Niceness() { return getpriority(PRIO_PROCESS, static_cast<id_t>(gettid())); }

TEST(BackgroundTest, WorkGivesWayAndItsCallerDoesNot) {
  const int before = Niceness();
  int inside = before;
  EXPECT_THAT(InBackground([&] {
                inside = Niceness();
                return absl::OkStatus();
              }),
              IsOk());
  EXPECT_GT(inside, before);
  EXPECT_EQ(Niceness(), before);
}

TEST(BackgroundTest, ErrorsComeBack) {
  EXPECT_THAT(InBackground([] { return absl::AbortedError("again"); }),
              StatusIs(absl::StatusCode::kAborted));
}

TEST(BackgroundTest, WhatLibrariesThrowReachesTheCaller) {
  const auto work = []() -> absl::Status { throw std::runtime_error("of a library"); };
  EXPECT_THROW((void)InBackground(work), std::runtime_error);
}

}  // namespace
}  // namespace graspdb::server
