#include "server/live/idle_task.h"

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <new>
#include <string>

#include "program/base/stop_flag.h"
#include "storage/catalogue/catalogue.h"
#include "tests/files/temporary_folder.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::testing {
namespace {

constexpr std::chrono::milliseconds kShort{1};
constexpr std::chrono::minutes kLong{1};

class IdleTaskTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto opened = storage::Catalogue::Open((folder_.path() / "db").string());
    ASSERT_THAT(opened, IsOk());
    catalogue_ = *std::move(opened);
    auto followed = server::LiveCatalogue::Follow(*catalogue_, {});
    ASSERT_THAT(followed, IsOk());
    live_ = *std::move(followed);
  }

  const files::TemporaryFolder folder_;
  std::unique_ptr<storage::Catalogue> catalogue_;
  std::unique_ptr<server::LiveCatalogue> live_;
};

TEST_F(IdleTaskTest, ACatalogueThatNeverRestsKeepsOnlyTheIdleTaskWaiting) {
  StopFlag ran_often;
  int rounds = 0;
  bool was_idle = false;
  const auto change = [&] {
    v1::Cell cell;
    cell.set_name("cells/c" + std::to_string(++rounds));
    EXPECT_THAT(catalogue_->CreateCell(cell), IsOk());
    if (rounds == 5) ran_often.Raise();
  };
  {
    const server::IdleTask task(*live_, {.always = change, .when_idle = [&] { was_idle = true; }},
                                kShort);
    EXPECT_TRUE(ran_often.Wait(kLong));
  }
  EXPECT_FALSE(was_idle);
}

TEST_F(IdleTaskTest, BothRunWhileTheCatalogueIsIdle) {
  StopFlag ran;
  bool always = false;
  {
    const server::IdleTask task(
        *live_, {.always = [&] { always = true; }, .when_idle = [&] { ran.Raise(); }}, kShort);
    EXPECT_TRUE(ran.Wait(kLong));
  }
  EXPECT_TRUE(always);
}

TEST_F(IdleTaskTest, ATaskThatThrowsRunsAgainAndEndsNoOther) {
  StopFlag ran_often;
  int rounds = 0;
  int idle_rounds = 0;
  const auto fail = [&] {
    ++rounds;
    throw std::bad_alloc();
  };
  const auto fail_often = [&] {
    if (++idle_rounds == 3) ran_often.Raise();
    throw std::bad_alloc();
  };
  {
    const server::IdleTask task(*live_, {.always = fail, .when_idle = fail_often}, kShort);
    EXPECT_TRUE(ran_often.Wait(kLong));
  }
  EXPECT_GE(rounds, 3);
}

}  // namespace
}  // namespace graspdb::testing
