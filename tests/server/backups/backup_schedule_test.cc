// Scheduled backups.
#include <gmock/gmock.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>

#include "storage/backups/backups.h"
#include "tests/server/server_fixture.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::testing {
namespace {

using ::testing::HasSubstr;

class BackupScheduleTest : public ServerTest {
 protected:
  void SetUp() override {
    options_.backup_dir = (folder_.path() / "backups").string();
    std::filesystem::create_directory(options_.backup_dir);
    options_.backup_every_s = 3600;
    ServerTest::SetUp();
  }

  // Waits, until the test's limit, for a state of the backups.
  v1::BackupStatus WaitFor(const std::function<bool(const v1::BackupStatus&)>& is_reached) {
    for (;;) {
      v1::BackupStatus status = Status().backup();
      if (is_reached(status) || HasFailure()) return status;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }

  static bool HasOne(const v1::BackupStatus& status) { return status.has_last_good_backup(); }
  static int IdOf(const v1::BackupStatus& status) {
    const std::string& name = status.last_good_backup().name();
    return name.empty() ? 0 : std::stoi(name.substr(name.find('/') + 1));
  }
};

TEST_F(BackupScheduleTest, MakesTheFirstOneAtOnceAndNoneBeforeItIsDue) {
  const v1::BackupStatus first = WaitFor(HasOne);
  EXPECT_EQ(first.interval_s(), 3600);
  Restart();
  Restart();
  EXPECT_EQ(Status().backup().backup_count(), 1) << "as old as the interval at least";
}

TEST_F(BackupScheduleTest, GoesOnAndDeletesOldOnes) {
  options_.backup_every_s = 0.02;
  options_.backup_keep = 2;
  Restart();
  const v1::BackupStatus status =
      WaitFor([](const auto& seen) { return IdOf(seen) >= 6 && seen.backup_count() == 2; });
  EXPECT_EQ(status.last_error(), "");
  ASSERT_THAT(CreateObject("mug"), IsGrpcOk());
  const std::int64_t revision = Status().catalog_revision();
  WaitFor([&](const auto& seen) { return seen.last_good_backup().catalog_revision() == revision; });
}

TEST_F(BackupScheduleTest, SurvivesFailuresAndGoesOnAfterThem) {
  options_.backup_every_s = 0.02;
  Restart();
  WaitFor(HasOne);
  // Between two servers: RocksDB makes the folder again if a backup is being made.
  server_.reset();
  const std::filesystem::path away = folder_.path() / "away";
  std::filesystem::rename(options_.backup_dir, away);
  Start();
  const v1::BackupStatus failed =
      WaitFor([](const auto& seen) { return !seen.last_error().empty(); });
  EXPECT_THAT(failed.last_error(), HasSubstr("mount its disk"));
  EXPECT_THAT(CreateObject("mug"), IsGrpcOk());
  std::filesystem::rename(away, options_.backup_dir);
  const std::int64_t revision = Status().catalog_revision();
  WaitFor([&](const auto& seen) {
    return seen.last_error().empty() && seen.last_good_backup().catalog_revision() == revision;
  });
}

TEST_F(BackupScheduleTest, ShutdownDoesNotWaitForABackup) {
  WaitFor(HasOne);
  Teach("wedge", 12);
  options_.backup_every_s = 0.001;
  options_.backup_rate_mib = 0.05;  // many seconds for these views
  Restart();
  server_->Drain();
  EXPECT_EQ(storage::Backups(options_.backup_dir).List()->size(), 1U) << "the second was ended";
}

}  // namespace
}  // namespace graspdb::testing
