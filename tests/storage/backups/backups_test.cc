// Backups: made online, shared files, listed, deleted.
#include "storage/backups/backups.h"

#include <atomic>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "absl/time/clock.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "storage/backups/watched_reads.h"
#include "storage/catalogue/catalogue.h"
#include "tests/storage/backup_fixture.h"
#include "tests/storage/catalogue_fixture.h"

namespace graspdb::storage {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class BackupsTest : public BackupTest {};

TEST_F(BackupsTest, RestoredCatalogueIsTheOriginalAtEachRevision) {
  const auto catalogue = OpenOrDie(database_);
  std::vector<Picture> history;
  MakeHistory(*catalogue, [&] {
    const auto made = backups_.Create(*catalogue);
    ASSERT_TRUE(made.ok()) << made.status();
    history.push_back(*TakePicture(*catalogue));
    EXPECT_EQ(made->id, history.size());
    EXPECT_EQ(made->record.meta().revision(), catalogue->revision());
    EXPECT_EQ(made->record.meta().view_count(), catalogue->counts().views);
    EXPECT_EQ(made->record.meta().schema_version(), catalogue->schema_version());
  });
  for (std::size_t i = 0; i < history.size(); ++i) {
    EXPECT_EQ(Restored(static_cast<BackupId>(i + 1)), history[i]) << i;
  }
}

TEST_F(BackupsTest, ARepeatedRequestGetsTheBackupThatItMade) {
  auto catalogue = OpenOrDie(database_);
  MakeHistory(*catalogue, [] {});
  const auto first = backups_.Create(*catalogue, {}, "a request");
  ASSERT_TRUE(first.ok()) << first.status();
  ASSERT_TRUE(catalogue->CreateCell(MakeCell("later")).ok());
  ASSERT_TRUE(backups_.Create(*catalogue, {}, "another").ok());
  catalogue = nullptr;
  catalogue = OpenOrDie(database_);
  const auto again = backups_.Create(*catalogue, {}, "a request");
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(again->id, first->id);
  EXPECT_EQ(again->record.SerializeAsString(), first->record.SerializeAsString());
  EXPECT_THAT(Ids(), ElementsAre(1, 2));
  for (int i = 0; i < 2; ++i) ASSERT_TRUE(backups_.Create(*catalogue).ok());
  EXPECT_THAT(Ids(), ElementsAre(1, 2, 3, 4)) << "without an id each makes one";
}

TEST_F(BackupsTest, RestoredCatalogueGoesOnWithTheNextRevision) {
  const auto catalogue = OpenOrDie(database_);
  MakeHistory(*catalogue, [] {});
  ASSERT_TRUE(backups_.Create(*catalogue).ok());
  ASSERT_TRUE(catalogue->CreateCell(MakeCell("later")).ok());
  const std::string other = directory_ / "other";
  ASSERT_TRUE(backups_.Restore(1, other).ok());
  const auto restored = OpenOrDie(other);
  EXPECT_EQ(restored->revision(), 12);
  ASSERT_TRUE(restored->CreateCell(MakeCell("other")).ok());
  EXPECT_EQ(restored->revision(), 13);
  // Its backups may go to the same folder as those of the original.
  ASSERT_TRUE(backups_.Create(*restored).ok());
  const Picture picture = *TakePicture(*restored);
  EXPECT_EQ(Restored(2), picture);
}

TEST_F(BackupsTest, UnchangedFilesAreSharedAndNotReadAgain) {
  std::int64_t read = 0;
  BackupProgress reads;
  reads.on_bytes = [&read](std::int64_t bytes) { read = bytes; };
  const auto disk = WatchReads(reads);
  CatalogueOptions options;
  options.env = disk.get();
  const auto catalogue = OpenOrDie(database_, options);
  StoreViews(*catalogue, 0, 40);
  ASSERT_TRUE(backups_.Create(*catalogue).ok());
  const std::int64_t first = BytesOf(directory_ / "backups");
  ASSERT_GT(first, 800'000);
  const std::int64_t read_before = read;
  ASSERT_GE(read_before, first / 2);
  StoreViews(*catalogue, 40, 1);
  const auto second = backups_.Create(*catalogue);
  ASSERT_TRUE(second.ok()) << second.status();
  EXPECT_GT(second->byte_count, first / 2) << "all its files, shared ones included";
  EXPECT_LT(BytesOf(directory_ / "backups") - first, first / 4);
  EXPECT_LT(read - read_before, first / 4);
  // The first can be deleted, and the second remains complete.
  ASSERT_TRUE(backups_.Delete(1).ok());
  EXPECT_TRUE(backups_.Verify(2).ok());
  const Picture picture = *TakePicture(*catalogue);
  EXPECT_EQ(Restored(2), picture);
}

TEST_F(BackupsTest, BackupsDuringWritesContainEveryWriteAcknowledgedBefore) {
  const auto catalogue = OpenOrDie(database_, SmallBuffers());
  std::atomic<bool> stop = false;
  StoreViews(*catalogue, 0, 1);
  std::thread writer([&] {
    for (std::int64_t i = 1; !stop; ++i) StoreViews(*catalogue, i, 1);
  });
  for (BackupId id = 1; id <= 8; ++id) {
    const std::int64_t before = catalogue->revision();
    const auto made = backups_.Create(*catalogue);
    const std::int64_t after = catalogue->revision();
    ASSERT_TRUE(made.ok()) << made.status();
    EXPECT_GE(made->record.meta().revision(), before);
    EXPECT_LE(made->record.meta().revision(), after);
  }
  stop = true;
  writer.join();
  const auto listed = backups_.List();
  ASSERT_TRUE(listed.ok()) << listed.status();
  for (const Backup& backup : *listed) {
    const Picture picture = Restored(backup.id);  // consistent in itself
    ASSERT_EQ(picture.revision, backup.record.meta().revision());
    for (std::int64_t i = 0; i < backup.record.meta().view_count(); ++i) {
      ASSERT_EQ(picture.clouds.at(WrittenViewName(i)), WrittenCloud(i));
    }
  }
}

TEST_F(BackupsTest, ChangesGoOnWhileFilesAreCopied) {
  const auto catalogue = OpenOrDie(database_);
  StoreViews(*catalogue, 0, 150);
  std::atomic<int> changes = 0;
  BackupProgress progress;
  progress.on_bytes = [&](std::int64_t) {
    ASSERT_TRUE(catalogue->CreateCell(MakeCell("cell-" + std::to_string(changes++))).ok());
  };
  const auto made = backups_.Create(*catalogue, progress);
  ASSERT_TRUE(made.ok()) << made.status();
  EXPECT_GT(changes, 1);
  EXPECT_EQ(catalogue->revision(), made->record.meta().revision() + changes);
}

TEST_F(BackupsTest, CancelledBackupLeavesNothing) {
  const auto catalogue = OpenOrDie(database_);
  StoreViews(*catalogue, 0, 150);
  BackupProgress progress;
  progress.is_cancelled = [] { return true; };
  EXPECT_EQ(backups_.Create(*catalogue, progress).status().code(), absl::StatusCode::kCancelled);
  EXPECT_THAT(*backups_.List(), IsEmpty());
  EXPECT_LT(BytesOf(directory_ / "backups"), 1000);
  const auto made = backups_.Create(*catalogue);
  ASSERT_TRUE(made.ok()) << made.status();
  EXPECT_TRUE(backups_.Verify(made->id).ok());
}

TEST_F(BackupsTest, DamageOfTheDatabaseIsFoundWhenItIsCopied) {
  StoreViews(*OpenOrDie(database_), 0, 60);
  for (const char* extension : {".sst", ".blob"}) {
    const std::string copy = directory_ / "copy";
    CopyDatabase(database_, copy);
    // Damage of an open database: opening it reads the blocks of a file that describe it, and a
    // byte of these would be found there. Nothing is compacted: one flush makes a file a family.
    const auto catalogue = OpenOrDie(copy);
    const std::filesystem::path file = LargestFile(copy, extension);
    FlipByte(file, std::filesystem::file_size(file) / 2);
    const auto made = backups_.Create(*catalogue);
    EXPECT_EQ(made.status().code(), absl::StatusCode::kDataLoss) << made.status();
    EXPECT_THAT(std::string(made.status().message()), HasSubstr(file.stem().string()));
    EXPECT_THAT(std::string(made.status().message()), HasSubstr("graspdb backup restore --from"));
    EXPECT_THAT(*backups_.List(), IsEmpty());
  }
}

TEST_F(BackupsTest, OldOnesAreDeletedByCountAndAge) {
  const auto catalogue = OpenOrDie(database_);
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(backups_.Create(*catalogue).ok());
  const absl::Time now = absl::Now();
  EXPECT_THAT(*backups_.DeleteOld({}, now), IsEmpty());
  EXPECT_THAT(*backups_.DeleteOld({.count = 3}, now), ElementsAre(2, 1));
  EXPECT_THAT(Ids(), ElementsAre(3, 4, 5));
  EXPECT_THAT(*backups_.DeleteOld({.max_age = absl::Hours(1)}, now), IsEmpty());
  EXPECT_THAT(*backups_.DeleteOld({.max_age = absl::Hours(1)}, now + absl::Hours(2)),
              ElementsAre(4, 3));
  EXPECT_THAT(*backups_.DeleteOld({.count = 0}, now), IsEmpty()) << "the newest stays";
  EXPECT_THAT(Ids(), ElementsAre(5));
  EXPECT_EQ(backups_.Create(*catalogue)->id, 6U) << "numbers are not used again";
}

TEST_F(BackupsTest, DamagedOnesDoNotReplaceIntactOnes) {
  const auto catalogue = OpenOrDie(database_);
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(backups_.Create(*catalogue).ok());
  std::filesystem::remove(LargestFile(directory_ / "backups/private/3", ""));
  EXPECT_THAT(*backups_.DeleteOld({.count = 1}, absl::Now()), ElementsAre(1));
  EXPECT_THAT(Ids(), ElementsAre(2, 3));
  EXPECT_EQ(backups_.List()->at(1).state.code(), absl::StatusCode::kDataLoss);
  EXPECT_TRUE(backups_.Delete(3).ok());
  EXPECT_THAT(Ids(), ElementsAre(2));
}

TEST_F(BackupsTest, OnesWithKnownDamageDoNotReplaceIntactOnes) {
  const auto catalogue = OpenOrDie(database_);
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(backups_.Create(*catalogue).ok());
  const BackupRetention one = {.count = 1, .damaged = {2, 4}};
  EXPECT_THAT(*backups_.DeleteOld(one, absl::Now()), ElementsAre(1));
  EXPECT_THAT(Ids(), ElementsAre(2, 3, 4));
}

TEST_F(BackupsTest, MissingBackupsAreNamed) {
  EXPECT_EQ(backups_.List().status().code(), absl::StatusCode::kNotFound);
  EXPECT_TRUE(std::filesystem::is_empty(directory_ / "backups")) << "reading makes no file";
  ASSERT_TRUE(backups_.Claim().ok());
  EXPECT_THAT(*backups_.List(), IsEmpty());
  EXPECT_EQ(backups_.Verify(7).status().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(backups_.Delete(7).code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(backups_.Restore(7, restored_).status().code(), absl::StatusCode::kNotFound);
  EXPECT_FALSE(std::filesystem::exists(restored_));
}

TEST_F(BackupsTest, OneOperationAtATimeButListing) {
  const auto catalogue = OpenOrDie(database_);
  StoreViews(*catalogue, 0, 150);
  ASSERT_TRUE(backups_.Create(*catalogue).ok());
  int rejected = 0;
  BackupProgress progress;
  progress.on_bytes = [&](std::int64_t) {
    rejected += absl::IsAborted(backups_.Create(*catalogue).status()) ? 1 : 0;
    rejected += absl::IsAborted(backups_.Delete(1)) ? 1 : 0;
    EXPECT_THAT(Ids(), ElementsAre(1));
  };
  ASSERT_TRUE(backups_.Verify(1, progress).ok());
  EXPECT_GE(rejected, 2);
  EXPECT_TRUE(backups_.Delete(1).ok());
}

}  // namespace
}  // namespace graspdb::storage
