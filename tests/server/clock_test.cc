// A wall clock that is set while the server runs.
#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <string>
#include <thread>

#include "program/stop_flag.h"
#include "server/expiry.h"
#include "server/upload_rate.h"
#include "storage/catalogue.h"
#include "storage/history.h"
#include "storage/uploads.h"
#include "tests/files/temporary_folder.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::testing {
namespace {

using std::chrono::hours;

class ExpiryTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto opened = storage::Catalogue::Open((folder_.path() / "db").string());
    ASSERT_THAT(opened, IsOk());
    catalogue_ = *std::move(opened);
    storage::UploadRecord wanted;
    wanted.set_name(kName);
    ASSERT_THAT(catalogue_->uploads().Create(wanted, kCreated), IsOk());
  }
  // Whether the upload is left at these times after its creation.
  bool IsLeft(absl::Duration wall, hours monotonic) {
    expiry_.Run(*catalogue_, kCreated + wall, kStart + monotonic);
    return catalogue_->uploads().Get(kName).ok();
  }

  static constexpr char kName[] = "uploads/bulk";
  static constexpr absl::Time kCreated = absl::FromUnixSeconds(1'700'000'000);
  static constexpr server::Expiry::Clock::time_point kStart{hours(1000)};

  const client::TemporaryFolder folder_;
  std::unique_ptr<storage::Catalogue> catalogue_;
  server::Expiry expiry_{absl::Hours(30 * 24)};
};

TEST_F(ExpiryTest, AnOldUploadIsDeletedAfterSevenDays) {
  EXPECT_TRUE(IsLeft(absl::Hours(1), hours(1)));
  EXPECT_TRUE(IsLeft(absl::Hours(7 * 24), hours(7 * 24)));
  EXPECT_FALSE(IsLeft(absl::Hours(7 * 24 + 1), hours(7 * 24 + 1)));
}

TEST_F(ExpiryTest, AClockSetAheadDeletesNothing) {
  EXPECT_TRUE(IsLeft(absl::Hours(1), hours(1)));
  EXPECT_TRUE(IsLeft(absl::Hours(365 * 24), hours(2)));
  EXPECT_TRUE(IsLeft(absl::Hours(365 * 24 + 24), hours(26)));
  EXPECT_TRUE(IsLeft(absl::Hours(28), hours(28))) << "set right again";
  EXPECT_FALSE(IsLeft(absl::Hours(8 * 24), hours(8 * 24)));
}

TEST_F(ExpiryTest, AClockSetBackDoesNotStopIt) {
  EXPECT_TRUE(IsLeft(absl::Hours(24), hours(24)));
  EXPECT_TRUE(IsLeft(absl::Hours(-24), hours(25)));
  EXPECT_TRUE(IsLeft(absl::Hours(6 * 24), hours(25 + 7 * 24)));
  EXPECT_FALSE(IsLeft(absl::Hours(8 * 24), hours(25 + 9 * 24)));
}

TEST_F(ExpiryTest, ADeletedObjectIsPurgedAfterItsTime) {
  v1::Object object;
  object.set_name("objects/mug");
  ASSERT_THAT(catalogue_->CreateObject(object), IsOk());
  ASSERT_THAT(catalogue_->DeleteObject("objects/mug", false, ""), IsOk());
  const absl::Time deleted = absl::Now();
  const auto is_kept = [&](absl::Duration age, hours monotonic) {
    expiry_.Run(*catalogue_, deleted + age, kStart + monotonic);
    return catalogue_->history().GetDeleted("objects/mug").ok();
  };
  EXPECT_TRUE(is_kept(absl::Hours(1), hours(1)));
  EXPECT_TRUE(is_kept(absl::Hours(30 * 24 - 1), hours(30 * 24 - 1)));
  EXPECT_FALSE(is_kept(absl::Hours(30 * 24 + 1), hours(30 * 24 + 1)));
}

TEST_F(ExpiryTest, AClockThatIsAYearAheadAtTheStartPurgesNothing) {
  v1::Object object;
  object.set_name("objects/mug");
  ASSERT_THAT(catalogue_->CreateObject(object), IsOk());
  ASSERT_THAT(catalogue_->DeleteObject("objects/mug", false, ""), IsOk());
  const absl::Time deleted = absl::Now();
  const auto is_kept = [&](absl::Duration age, hours monotonic) {
    expiry_.Run(*catalogue_, deleted + age, kStart + monotonic);
    return catalogue_->history().GetDeleted("objects/mug").ok();
  };
  EXPECT_TRUE(is_kept(absl::Hours(365 * 24), hours(0)));
  EXPECT_TRUE(is_kept(absl::Hours(365 * 24 + 1), hours(1)));
  EXPECT_TRUE(is_kept(absl::Hours(30 * 24 - 1), hours(30 * 24 - 1))) << "set right";
  EXPECT_FALSE(is_kept(absl::Hours(30 * 24 + 2), hours(30 * 24 + 2)));
}

TEST(UploadRateTest, CountsTheLastHalfMinute) {
  server::UploadRate rate;
  const server::UploadRate::Clock::time_point start{hours(1)};
  for (int second = 0; second < 100; ++second) {
    for (int i = 0; i < 3; ++i) rate.Add(start + std::chrono::seconds(second));
  }
  EXPECT_NEAR(rate.PerSecond(start + std::chrono::seconds(99)), 3, 0.2);
  EXPECT_EQ(rate.PerSecond(start + std::chrono::seconds(200)), 0);
}

TEST(StopFlagTest, WaitsUntilItIsRaised) {
  StopFlag flag;
  EXPECT_FALSE(flag.Wait(std::chrono::milliseconds(1)));
  std::thread other([&] { flag.Raise(); });
  EXPECT_TRUE(flag.Wait(hours(1)));
  other.join();
  EXPECT_TRUE(flag.Wait(std::chrono::nanoseconds(0)));
}

}  // namespace
}  // namespace graspdb::testing
