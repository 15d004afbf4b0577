// A wall clock that is set while the server runs.
#include <gmock/gmock.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "program/base/stop_flag.h"
#include "server/backups/backup_schedule.h"
#include "server/backups/catalogue_backups.h"
#include "server/history/expiry.h"
#include "server/uploads/upload_service.h"
#include "storage/catalogue/catalogue.h"
#include "storage/history/history.h"
#include "storage/uploads/uploads.h"
#include "tests/files/temporary_folder.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::testing {
namespace {

using std::chrono::hours;
using ::testing::ElementsAre;

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

  const files::TemporaryFolder folder_;
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

TEST_F(ExpiryTest, AClockThatWasSetBackForSomeDaysMakesNothingLate) {
  EXPECT_TRUE(IsLeft(absl::Hours(1), hours(1)));
  EXPECT_TRUE(IsLeft(absl::Hours(-5 * 24), hours(2)));
  EXPECT_TRUE(IsLeft(absl::Hours(7 * 24), hours(7 * 24))) << "set right again";
  EXPECT_FALSE(IsLeft(absl::Hours(7 * 24 + 2), hours(7 * 24 + 2)));
}

// A deleted object, which is kept for 30 days.
class DeletedObjectExpiryTest : public ExpiryTest {
 protected:
  void SetUp() override {
    ExpiryTest::SetUp();
    v1::Object object;
    object.set_name("objects/mug");
    ASSERT_THAT(catalogue_->CreateObject(object), IsOk());
    ASSERT_THAT(catalogue_->DeleteObject("objects/mug", false, ""), IsOk());
    deleted_ = absl::Now();
  }

  bool IsKept(absl::Duration age, hours monotonic) {
    expiry_.Run(*catalogue_, deleted_ + age, kStart + monotonic);
    return catalogue_->history().GetDeleted("objects/mug").ok();
  }

  absl::Time deleted_;
};

TEST_F(DeletedObjectExpiryTest, IsPurgedAfterItsTime) {
  EXPECT_TRUE(IsKept(absl::Hours(1), hours(1)));
  EXPECT_TRUE(IsKept(absl::Hours(30 * 24 - 1), hours(30 * 24 - 1)));
  EXPECT_FALSE(IsKept(absl::Hours(30 * 24 + 1), hours(30 * 24 + 1)));
}

TEST_F(DeletedObjectExpiryTest, AClockThatIsAYearAheadAtTheStartPurgesNothing) {
  EXPECT_TRUE(IsKept(absl::Hours(365 * 24), hours(0)));
  EXPECT_TRUE(IsKept(absl::Hours(365 * 24 + 1), hours(1)));
  EXPECT_TRUE(IsKept(absl::Hours(30 * 24 - 1), hours(30 * 24 - 1))) << "set right";
  EXPECT_FALSE(IsKept(absl::Hours(30 * 24 + 2), hours(30 * 24 + 2)));
}

class BackupRoundsTest : public ::testing::Test {
 protected:
  static constexpr absl::Duration kDay = absl::Hours(24);

  void SetUp() override {
    storage::CatalogueOptions catalogue_options;
    catalogue_options.clock = [this] { return wall_; };
    auto opened = storage::Catalogue::Open((folder_.path() / "db").string(), catalogue_options);
    ASSERT_THAT(opened, IsOk());
    catalogue_ = *std::move(opened);
    server::ServerOptions options;
    options.backup_dir = (folder_.path() / "backups").string();
    std::filesystem::create_directory(options.backup_dir);
    auto backups = server::CatalogueBackups::Open(options, *catalogue_);
    ASSERT_THAT(backups, IsOk());
    backups_ = *std::move(backups);
    rounds_.emplace(*backups_, kDay, storage::BackupRetention{.max_age = 20 * kDay}, wall_,
                    monotonic_);
  }
  std::vector<storage::BackupId> Ids() {
    std::vector<storage::BackupId> out;
    const auto listed = backups_->List();
    EXPECT_THAT(listed, IsOk());
    if (!listed.ok()) return out;
    out.reserve(listed->size());
    for (const storage::Backup& backup : *listed) out.push_back(backup.id);
    return out;
  }
  // Number of backups that are made in a time.
  int MadeIn(absl::Duration time) {
    const std::vector<storage::BackupId> before = Ids();
    int without_wait = 0;
    absl::Duration passed;
    while (passed < time) {
      const absl::Duration wait = rounds_->Run(wall_, monotonic_);
      if (wait <= absl::ZeroDuration() && ++without_wait > 100) {
        ADD_FAILURE() << "a loop without a wait";
        break;
      }
      passed += wait;
      wall_ += wait;
      monotonic_ += absl::ToChronoNanoseconds(wait);
    }
    const std::vector<storage::BackupId> after = Ids();
    if (after.empty()) return 0;
    return static_cast<int>(after.back() - (before.empty() ? 0 : before.back()));
  }

  const files::TemporaryFolder folder_;
  absl::Time wall_ = absl::FromUnixSeconds(1'700'000'000);
  server::BackupRounds::Clock::time_point monotonic_{hours(1000)};
  std::unique_ptr<storage::Catalogue> catalogue_;
  std::unique_ptr<server::CatalogueBackups> backups_;
  std::optional<server::BackupRounds> rounds_;
};

TEST_F(BackupRoundsTest, AClockSetAheadByAYearMakesOneBackupDueAndNoneOld) {
  EXPECT_EQ(MadeIn(5 * kDay + absl::Hours(1)), 6);
  wall_ += 365 * kDay;
  EXPECT_EQ(MadeIn(absl::Hours(1)), 1);
  EXPECT_EQ(MadeIn(3 * kDay), 3);
  wall_ -= 365 * kDay;  // set right again: the newest one is of the future
  EXPECT_EQ(MadeIn(absl::Hours(1)), 1);
  EXPECT_EQ(MadeIn(2 * kDay), 2);
  EXPECT_EQ(Ids().size(), 13U) << "none was deleted";
  EXPECT_EQ(MadeIn(20 * kDay), 20);
  EXPECT_EQ(Ids().front(), 7U) << "those of before are old now";
}

TEST_F(BackupRoundsTest, AClockSetBackByAYearDoesNotStopThem) {
  EXPECT_EQ(MadeIn(absl::Hours(1)), 1);
  wall_ -= 365 * kDay;
  EXPECT_EQ(MadeIn(absl::Hours(1)), 1);
  EXPECT_EQ(MadeIn(3 * kDay), 3);
  EXPECT_THAT(Ids(), ElementsAre(1, 2, 3, 4, 5));
  wall_ += 365 * kDay;
  EXPECT_EQ(MadeIn(absl::Hours(1)), 1);
  EXPECT_THAT(Ids(), ElementsAre(1, 6)) << "by their time the others are a year old";
  EXPECT_EQ(MadeIn(3 * kDay), 3);
}

TEST_F(BackupRoundsTest, OnesThatVerifyFoundDamagedStayAndDoNotCount) {
  rounds_.emplace(*backups_, kDay, storage::BackupRetention{.count = 2}, wall_, monotonic_);
  EXPECT_EQ(MadeIn(kDay + absl::Hours(1)), 2);
  const std::filesystem::path manifests = folder_.path() / "backups/private/2";
  for (const auto& entry : std::filesystem::directory_iterator(manifests)) {
    std::fstream file(entry.path(), std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(static_cast<std::streamoff>(entry.file_size() / 2));
    file.put('\0');
  }
  EXPECT_TRUE(absl::IsDataLoss(backups_->Verify(2, {}).status()));
  MadeIn(2 * kDay);
  const std::vector<storage::BackupId> left = Ids();
  ASSERT_EQ(left.size(), 3U) << "two intact ones and the damaged one";
  EXPECT_EQ(left.front(), 2U);
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
