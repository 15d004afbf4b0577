// The folder of backups: its name, its owner, permissions.
#include <filesystem>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "storage/backups/backups.h"
#include "tests/storage/backup_fixture.h"
#include "tests/storage/catalogue_fixture.h"
#include "tests/testing/unreadable_folder.h"

namespace graspdb::storage {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class BackupFolderTest : public BackupTest {};

TEST_F(BackupFolderTest, ARelativeFolderIsTheSame) {
  const auto catalogue = OpenOrDie(database_);
  MakeHistory(*catalogue, [] {});
  Backups relative(std::filesystem::relative(directory_ / "backups").string());
  ASSERT_TRUE(relative.Create(*catalogue).ok());
  const auto verified = relative.Verify(1);
  EXPECT_TRUE(verified.ok()) << verified.status();
  ASSERT_TRUE(relative.Restore(1, restored_).ok());
  EXPECT_EQ(*TakePicture(*OpenOrDie(restored_)), *TakePicture(*catalogue));
}

// A thread of RocksDB has the capabilities of the one that started it.
TEST_F(BackupFolderTest, AFolderThatMayNotBeReadIsNeitherEmptyNorDamaged) {
  using std::filesystem::perms;
  ASSERT_TRUE(backups_.Create(*OpenOrDie(database_)).ok());
  for (const char* name : {"", "/meta", "/shared_checksum", "/private", "/private/1"}) {
    const std::string folder = folder_ + name;
    const UnreadableFolder unreadable(folder, perms::none);
    for (const absl::Status& status : {backups_.List().status(), backups_.Verify(1).status(),
                                       backups_.Restore(1, restored_).status()}) {
      EXPECT_EQ(status.code(), absl::StatusCode::kUnavailable) << folder << " " << status;
      EXPECT_THAT(std::string(status.message()),
                  HasSubstr(" cannot be read (Permission denied); check its permissions"));
    }
  }
  EXPECT_THAT(Ids(), ElementsAre(1));
  EXPECT_TRUE(backups_.Verify(1).ok());
}

TEST_F(BackupFolderTest, AFolderThatMayNotBeReachedIsNotReportedAsMissing) {
  Backups backups(folder_);
  {
    const UnreadableFolder unreadable(directory_.path(), std::filesystem::perms::none);
    const absl::Status status = backups.Claim();
    EXPECT_EQ(status.code(), absl::StatusCode::kUnavailable);
    EXPECT_THAT(std::string(status.message()), HasSubstr("Permission denied"));
  }
  EXPECT_TRUE(backups.Claim().ok());
}

TEST_F(BackupFolderTest, FolderHasOneOwner) {
  ASSERT_TRUE(backups_.Claim().ok());
  Backups second(directory_ / "backups");
  const absl::Status rejected = second.Claim();
  EXPECT_EQ(rejected.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(rejected.message()), HasSubstr("in use"));
  EXPECT_TRUE(second.List().ok()) << "reading needs no ownership";
  const auto catalogue = OpenOrDie(database_);
  EXPECT_FALSE(second.Create(*catalogue).ok());
  EXPECT_FALSE(second.Delete(1).ok());
}

TEST_F(BackupFolderTest, FolderWithOtherFilesIsRejected) {
  WriteBytes(directory_ / "backups/diary.txt", "Dear diary");
  const absl::Status rejected = backups_.Claim();
  EXPECT_EQ(rejected.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(rejected.message()), HasSubstr("diary.txt"));
}

TEST_F(BackupFolderTest, TheFolderIsNotMadeAsItsDiskMayBeMissing) {
  const auto catalogue = OpenOrDie(database_);
  Backups backups(directory_ / "unmounted");
  for (int remount = 0; remount < 2; ++remount) {
    EXPECT_EQ(backups.Claim().code(), absl::StatusCode::kUnavailable);
    EXPECT_EQ(backups.Create(*catalogue).status().code(), absl::StatusCode::kUnavailable);
    EXPECT_FALSE(std::filesystem::exists(directory_ / "unmounted"));
    std::filesystem::create_directory(directory_ / "unmounted");
    EXPECT_TRUE(backups.Create(*catalogue).ok());
    std::filesystem::remove_all(directory_ / "unmounted");
  }
}

// As after the disk of the backups was replaced while the server runs.
TEST_F(BackupFolderTest, AnotherFolderThatGetsTheNameIsClaimed) {
  const auto catalogue = OpenOrDie(database_);
  ASSERT_TRUE(backups_.Create(*catalogue).ok());
  std::filesystem::rename(folder_, directory_ / "unmounted");
  std::filesystem::create_directory(folder_);
  ASSERT_TRUE(backups_.Claim().ok());
  EXPECT_TRUE(std::filesystem::exists(folder_ + "/LOCK")) << "another process could claim it";
  EXPECT_TRUE(Ids().empty());
  const auto made = backups_.Create(*catalogue, {}, "request-1");
  EXPECT_TRUE(made.ok()) << made.status();
  EXPECT_THAT(Ids(), ElementsAre(1));
}

}  // namespace
}  // namespace graspdb::storage
