#include "server/live/upkeep.h"

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <new>

#include "program/base/stop_flag.h"
#include "storage/catalogue/catalogue.h"
#include "tests/files/temporary_folder.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::testing {
namespace {

constexpr std::chrono::milliseconds kShort{1};
constexpr std::chrono::minutes kLong{1};

class UpkeepTest : public ::testing::Test {
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

TEST_F(UpkeepTest, ATaskThatThrowsRunsAgain) {
  StopFlag ran_often;
  int rounds = 0;
  const auto fail = [&] {
    if (++rounds == 3) ran_often.Raise();
    throw std::bad_alloc();
  };
  const server::Upkeep upkeep(*live_, fail, kShort);
  EXPECT_TRUE(ran_often.Wait(kLong));
}

}  // namespace
}  // namespace graspdb::testing
