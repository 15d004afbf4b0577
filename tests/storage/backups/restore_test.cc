// Damaged backups, restores that are refused, and comparisons.
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "storage/backups/backup_engine.h"
#include "storage/backups/backups.h"
#include "storage/changes/schema.h"
#include "tests/storage/backup_fixture.h"
#include "tests/storage/rocksdb_access.h"
#include "tests/testing/watched_syncs.h"

namespace graspdb::storage {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class RestoreTest : public OneBackupTest {
 protected:
  std::vector<std::filesystem::path> FilesOfTheBackup() const {
    std::vector<std::filesystem::path> files;
    for (const char* folder : {"backups/shared_checksum", "backups/private/1", "backups/meta"}) {
      for (const auto& entry : std::filesystem::directory_iterator(directory_ / folder)) {
        files.push_back(entry.path());
      }
    }
    return files;
  }

  // Verification fails and names `file`.
  void ExpectVerifyFinds(const std::filesystem::path& file) {
    const auto verified = backups_.Verify(1);
    EXPECT_EQ(verified.status().code(), absl::StatusCode::kDataLoss) << file;
    EXPECT_THAT(std::string(verified.status().message()), HasSubstr("backup 1 in "));
    if (file.parent_path().filename() != "meta") {
      EXPECT_THAT(std::string(verified.status().message()), HasSubstr(file.filename().string()));
    }
  }

  // Verification and restore fail, name `file`, and leave no database.
  void ExpectDamageOf(const std::filesystem::path& file) {
    ExpectVerifyFinds(file);
    const auto restored = backups_.Restore(1, restored_);
    EXPECT_EQ(restored.status().code(), absl::StatusCode::kDataLoss) << file;
    EXPECT_FALSE(std::filesystem::exists(restored_)) << file;
  }

  std::vector<std::string> Names(const absl::StatusOr<Backup>& compared) const {
    EXPECT_TRUE(compared.ok()) << compared.status();
    return names_;
  }

  // For Backups::Compare().
  absl::Status Note(const Difference& difference) {
    constexpr std::array<char, 3> kSigns = {'+', '~', '-'};
    names_.push_back(kSigns[static_cast<std::size_t>(difference.kind)] + difference.name);
    return absl::OkStatus();
  }

  std::vector<std::string> names_;
};

TEST_F(RestoreTest, AFlippedByteInAnyFileIsFoundAndNamed) {
  ASSERT_TRUE(backups_.Verify(1).ok());
  const auto files = FilesOfTheBackup();
  ASSERT_GT(files.size(), 8U);
  for (const std::filesystem::path& file : files) {
    const std::string intact = ReadBytes(file);
    const bool is_meta = file.parent_path().filename() == "meta";
    // RocksDB's own time and sequence number, two lines, are not used.
    const std::size_t begin = is_meta ? intact.find('\n', intact.find('\n') + 1) + 1 : 0;
    const std::size_t step = is_meta ? 7 : std::max<std::size_t>(1, intact.size() / 3);
    for (std::size_t offset = begin; offset < intact.size(); offset += step) {
      FlipByte(file, offset);
      ExpectVerifyFinds(file);
      WriteBytes(file, intact);
    }
    FlipByte(file, intact.size() / 2);
    ExpectDamageOf(file);
    WriteBytes(file, intact);
  }
  EXPECT_TRUE(backups_.Verify(1).ok());
  EXPECT_EQ(Restored(1), original_);
}

TEST_F(RestoreTest, TruncatedFilesAreFoundAndMissingOnesWithoutReading) {
  for (const std::filesystem::path& file : FilesOfTheBackup()) {
    if (file.parent_path().filename() == "meta") continue;  // a backup without it does not exist
    const std::string intact = ReadBytes(file);
    WriteBytes(file, intact.substr(0, intact.size() - 1));
    ExpectVerifyFinds(file);
    std::filesystem::remove(file);
    EXPECT_EQ(backups_.List()->at(0).state.code(), absl::StatusCode::kDataLoss);
    ExpectDamageOf(file);
    WriteBytes(file, intact);
    EXPECT_TRUE(backups_.List()->at(0).state.ok());
  }
}

TEST_F(RestoreTest, ANewBackupReplacesAFileThatIsMissingInAnOlderOne) {
  std::filesystem::remove(LargestFile(directory_ / "backups/shared_checksum", ".blob"));
  const auto catalogue = OpenOrDie(database_);
  const auto made = backups_.Create(*catalogue);
  ASSERT_TRUE(made.ok()) << made.status();
  EXPECT_TRUE(backups_.Verify(2).ok());
  EXPECT_EQ(Restored(2), original_);
}

TEST_F(RestoreTest, ReadingChangesNoFileOfTheBackup) {
  std::map<std::filesystem::path, std::string> before;
  for (const auto& file : FilesOfTheBackup()) before[file] = ReadBytes(file);
  ASSERT_TRUE(backups_.Verify(1).ok());
  EXPECT_EQ(Restored(1), original_);
  EXPECT_THAT(
      Names(backups_.Compare(1, database_, {}, [this](const Difference& d) { return Note(d); })),
      IsEmpty());
  std::map<std::filesystem::path, std::string> after;
  for (const auto& file : FilesOfTheBackup()) after[file] = ReadBytes(file);
  EXPECT_EQ(before, after);
}

TEST_F(RestoreTest, EachRestoredDatabaseHasAnIdOfItsOwn) {
  std::set<std::string> ids = {OpenOrDie(database_)->id()};
  EXPECT_TRUE(ids.contains(backups_.Verify(1)->record.meta().catalog_id()));
  for (const char* name : {"restored", "again"}) {
    const std::string database = directory_ / name;
    ASSERT_TRUE(backups_.Restore(1, database).ok());
    const std::string id = OpenOrDie(database)->id();
    EXPECT_TRUE(ids.insert(id).second) << id;
    EXPECT_EQ(OpenOrDie(database)->id(), id) << "stays";
    EXPECT_EQ(*TakePicture(*OpenOrDie(database)), original_);
  }
}

TEST_F(RestoreTest, RestoresToMissingAndEmptyFoldersOnly) {
  const std::string deep = directory_ / "a/b/c/";
  {
    const WatchedSyncs syncs;
    ASSERT_TRUE(backups_.Restore(1, deep).ok());
    for (const char* durable : {"", "a", "a/b", "a/b/c"}) {
      EXPECT_TRUE(syncs.Flushed(directory_ / durable)) << durable;
    }
  }
  EXPECT_EQ(*TakePicture(*OpenOrDie(deep)), original_);
  const absl::Status again = backups_.Restore(1, deep).status();
  EXPECT_EQ(again.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(again.message()), HasSubstr("is not empty"));
  EXPECT_EQ(*TakePicture(*OpenOrDie(deep)), original_) << "unchanged";

  std::filesystem::create_directory(restored_);
  EXPECT_EQ(Restored(1), original_);
  WriteBytes(restored_, "a file");
  const absl::Status file = backups_.Restore(1, restored_).status();
  EXPECT_EQ(file.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(file.message()), HasSubstr("is not a folder"));
  EXPECT_EQ(ReadBytes(restored_), "a file");
}

TEST_F(RestoreTest, ALinkOfTheTemporaryNameIsNotFollowed) {
  const std::filesystem::path other = directory_ / "other";
  std::filesystem::create_directory(other);
  WriteBytes(other / "precious", "kept");
  std::filesystem::create_directory_symlink(other, directory_ / ".graspdb-restoring-restored");
  EXPECT_EQ(backups_.Restore(1, restored_).status().code(), absl::StatusCode::kUnavailable);
  EXPECT_EQ(ReadBytes(other / "precious"), "kept");
  EXPECT_FALSE(std::filesystem::exists(restored_));
}

TEST_F(RestoreTest, ABackupOfANewerProgramIsRefused) {
  { const auto closed = OpenOrDie(database_); }
  BackupRecord record;
  {
    const auto catalogue = OpenOrDie(database_);
    record = backups_.Create(*catalogue)->record;
  }
  // The record is in the file as hexadecimal digits.
  const std::string file = directory_ / "backups/meta/2";
  const auto hex = [](const std::string& bytes) {
    std::string digits;
    for (const char c : bytes) {
      constexpr std::string_view kDigits = "0123456789ABCDEF";
      digits += kDigits[static_cast<unsigned char>(c) >> 4];
      digits += kDigits[static_cast<unsigned char>(c) & 15];
    }
    return digits;
  };
  std::string text = ReadBytes(file);
  const std::string old = hex(EncodeBackupRecord(record));
  ASSERT_NE(text.find(old), std::string::npos) << text;
  record.mutable_meta()->set_schema_version(kSchemaVersion + 1);
  text.replace(text.find(old), old.size(), hex(EncodeBackupRecord(record)));
  WriteBytes(file, text);
  const absl::Status refused = backups_.Restore(2, restored_).status();
  EXPECT_EQ(refused.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(refused.message()), HasSubstr("newer program"));
  EXPECT_FALSE(std::filesystem::exists(restored_));
}

TEST_F(RestoreTest, ComparisonNamesWhatARestoreChanges) {
  const auto catalogue = OpenOrDie(database_);
  const auto note = [this](const Difference& difference) { return Note(difference); };
  EXPECT_THAT(Names(backups_.Compare(1, *catalogue, {}, note)), IsEmpty());
  ASSERT_TRUE(catalogue->DeleteView(WrittenViewName(3)).ok());
  ASSERT_TRUE(catalogue->CreateObject(MakeObject("bowl")).ok());
  ASSERT_TRUE(catalogue->CreateObject(MakeObject("a-cup")).ok());
  ASSERT_TRUE(catalogue->CreateCell(MakeCell("press")).ok());
  const auto rename = [](v1::StablePose& pose) {
    pose.set_display_name("Upright");
    return absl::OkStatus();
  };
  ASSERT_TRUE(catalogue->UpdateStablePose("objects/mug/stablePoses/upright", "", rename).ok());
  EXPECT_THAT(Names(backups_.Compare(1, *catalogue, {}, note)),
              ElementsAre("-objects/a-cup", "-objects/bowl", "~objects/mug/stablePoses/upright",
                          "+" + WrittenViewName(3), "-cells/press"));
  absl::Status ended = absl::OutOfRangeError("enough");
  EXPECT_EQ(backups_.Compare(1, *catalogue, {}, [&](const Difference&) { return ended; }).status(),
            ended);
  BackupProgress progress;
  progress.is_cancelled = [] { return true; };
  EXPECT_TRUE(absl::IsCancelled(backups_.Compare(1, *catalogue, progress, note).status()));
}

TEST_F(RestoreTest, ComparesWithAClosedDatabase) {
  FlushToFiles(database_);
  ASSERT_TRUE(OpenOrDie(database_)->DeleteObject("objects/mug", true, "").ok());
  const auto compared =
      backups_.Compare(1, database_, {}, [this](const Difference& d) { return Note(d); });
  ASSERT_EQ(Names(compared).size(), 62U);
  EXPECT_EQ(names_[0], "+objects/mug");
  EXPECT_EQ(compared->record.meta().revision(), original_.revision);
  const auto note = [this](const Difference& d) { return Note(d); };
  EXPECT_EQ(backups_.Compare(1, restored_, {}, note).status().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(backups_.Compare(1, folder_, {}, note).status().code(),
            absl::StatusCode::kFailedPrecondition);
}

TEST_F(RestoreTest, DoesNotCompareWithADatabaseThatIsOpen) {
  const auto note = [this](const Difference& d) { return Note(d); };
  {
    const auto catalogue = OpenOrDie(database_);
    const absl::Status refused = backups_.Compare(1, database_, {}, note).status();
    EXPECT_EQ(refused.code(), absl::StatusCode::kFailedPrecondition);
    EXPECT_THAT(std::string(refused.message()), HasSubstr("is in use by another process"));
  }
  EXPECT_TRUE(backups_.Compare(1, database_, {}, note).ok());
  EXPECT_TRUE(OpenOrDie(database_) != nullptr) << "the lock is free again";
}

}  // namespace
}  // namespace graspdb::storage
