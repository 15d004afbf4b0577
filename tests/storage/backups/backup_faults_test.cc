// Backups and restores that are cancelled or killed, or whose disk is full.
#include <sys/mount.h>
#include <sys/wait.h>

#include <filesystem>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "storage/backups/backups.h"
#include "tests/storage/backup_fixture.h"
#include "tests/storage/child_process.h"

namespace graspdb::storage {
namespace {

using ::testing::IsEmpty;

class BackupFaultsTest : public OneBackupTest {};

TEST_F(BackupFaultsTest, CancelledRestoreAndVerificationLeaveNothing) {
  for (std::int64_t limit : {1, 500'000}) {
    std::int64_t read = 0;
    BackupProgress progress;
    progress.on_bytes = [&](std::int64_t bytes) { read = bytes; };
    progress.is_cancelled = [&] { return read >= limit; };
    EXPECT_TRUE(absl::IsCancelled(backups_.Verify(1, progress).status()));
    read = 0;
    EXPECT_TRUE(absl::IsCancelled(backups_.Restore(1, restored_, progress).status()));
    EXPECT_FALSE(std::filesystem::exists(restored_));
    EXPECT_FALSE(std::filesystem::exists(directory_ / ".graspdb-restoring-restored"));
  }
}

TEST_F(BackupFaultsTest, AKilledRestoreLeavesNoDatabase) {
  int killed = 0;
  for (;; ++killed) {
    ChildProcess restore("restore", restored_, directory_ / "backups");
    bool running = true;
    for (int i = 0; i <= killed && running; ++i) running = restore.NextRevision().has_value();
    if (!running) break;  // it reports each portion that it has read
    restore.Kill();
    ASSERT_TRUE(WIFSIGNALED(restore.Wait()));
    if (std::filesystem::exists(restored_)) {  // it was complete before the signal
      EXPECT_EQ(*TakePicture(*OpenOrDie(restored_)), original_);
      std::filesystem::remove_all(restored_);
    }
  }
  EXPECT_GT(killed, 8);
  EXPECT_EQ(*TakePicture(*OpenOrDie(restored_)), original_);
  EXPECT_FALSE(std::filesystem::exists(directory_ / ".graspdb-restoring-restored"));
}

TEST_F(BackupFaultsTest, AKilledBackupIsNotListedAndTheNextOneIsComplete) {
  const std::string folder = directory_ / "killed";
  std::filesystem::create_directory(folder);
  for (int round = 0; round < 6; ++round) {
    ChildProcess process("backup", database_, folder);
    ASSERT_EQ(process.NextRevision(), original_.revision);
    std::int64_t finished = 0;
    for (int i = 0; i < 3 * round; ++i) {
      const auto id = process.NextRevision();
      ASSERT_TRUE(id.has_value());
      finished = *id;
    }
    process.Kill();
    ASSERT_TRUE(WIFSIGNALED(process.Wait()));
    const Backups backups(folder);
    const auto listed = backups.List();
    // It may have been killed before it made its first folder.
    if (finished == 0 && absl::IsNotFound(listed.status())) continue;
    ASSERT_TRUE(listed.ok()) << listed.status();
    EXPECT_GE(static_cast<std::int64_t>(listed->size()), finished);
    for (const Backup& backup : *listed) {
      EXPECT_TRUE(backup.state.ok()) << backup.state;
      const auto verified = backups.Verify(backup.id);
      EXPECT_TRUE(verified.ok()) << verified.status();
    }
  }
}

TEST_F(BackupFaultsTest, WhatAKilledBackupLeftIsDeletedBeforeChangesArePaused) {
  const std::filesystem::path left = directory_ / "backups/private/2";
  std::filesystem::create_directory(left);
  WriteBytes(left / "MANIFEST-000005", "half");
  const auto catalogue = OpenOrDie(database_);
  bool was_there = true;
  BackupProgress progress;
  progress.is_cancelled = [&] {  // first called with changes paused, before anything is copied
    was_there = std::filesystem::exists(left);
    return true;
  };
  EXPECT_TRUE(absl::IsCancelled(backups_.Create(*catalogue, progress).status()));
  EXPECT_FALSE(was_there);
  const auto made = backups_.Create(*catalogue);
  ASSERT_TRUE(made.ok()) << made.status();
  EXPECT_EQ(made->id, 2U);
  EXPECT_TRUE(backups_.Verify(1).ok());
  EXPECT_TRUE(backups_.Verify(2).ok());
}

TEST_F(BackupFaultsTest, AFullDiskEndsABackupAndFreeSpaceLetsTheNextOneSucceed) {
  const std::string disk = directory_ / "disk";
  std::filesystem::create_directory(disk);
  if (mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=1m") != 0) {
    GTEST_SKIP() << "mounting a small file system needs root";
  }
  {
    std::filesystem::create_directory(disk + "/backups");
    Backups backups(disk + "/backups");
    const auto catalogue = OpenOrDie(database_);
    const absl::Status full = backups.Create(*catalogue).status();
    EXPECT_EQ(full.code(), absl::StatusCode::kResourceExhausted) << full;
    EXPECT_THAT(*backups.List(), IsEmpty());
    EXPECT_TRUE(catalogue->CreateCell(MakeCell("goes-on")).ok());
    ASSERT_EQ(mount("", disk.c_str(), "", MS_REMOUNT, "size=64m"), 0);
    const auto made = backups.Create(*catalogue);
    EXPECT_TRUE(made.ok()) << made.status();
    EXPECT_TRUE(backups.Verify(1).ok());

    ASSERT_EQ(mount("", disk.c_str(), "", MS_REMOUNT, "size=3m"), 0);
    EXPECT_EQ(backups.Restore(1, disk + "/db").status().code(),
              absl::StatusCode::kResourceExhausted);
    EXPECT_FALSE(std::filesystem::exists(disk + "/db"));
  }
  EXPECT_EQ(umount(disk.c_str()), 0);
}

}  // namespace
}  // namespace graspdb::storage
