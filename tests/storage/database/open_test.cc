// Opening databases, and the errors.
#include <filesystem>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "program/base/uuid.h"
#include "storage/catalogue/catalogue.h"
#include "storage/changes/schema.h"
#include "storage/database/revision_floor.h"
#include "tests/storage/catalogue_fixture.h"
#include "tests/storage/child_process.h"
#include "tests/storage/rocksdb_access.h"
#include "tests/testing/unreadable_folder.h"

namespace graspdb::storage {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class OpenTest : public ::testing::Test {
 protected:
  absl::Status TryOpen() { return Catalogue::Open(database_).status(); }
  // Whether a second start took the owner's text log away.
  bool HasOldLog() const { return std::filesystem::exists(database_ + "/LOG.old"); }
  void MakeDatabase() {
    MakeHistory(*OpenOrDie(database_), [] {});
  }

  TemporaryDirectory directory_;
  const std::string database_ = directory_ / "db";
};

TEST_F(OpenTest, ADatabaseThatMayNotBeReadIsNotDamaged) {
  MakeDatabase();
  const std::string floor = database_ + "/" + std::string(kRevisionFloorFile);
  {
    const UnreadableFolder unreadable(database_, std::filesystem::perms::none);
    const absl::Status status = TryOpen();
    EXPECT_EQ(status.code(), absl::StatusCode::kUnavailable);
    EXPECT_THAT(std::string(status.message()),
                HasSubstr(floor + " cannot be read (Permission denied); check its permissions"));
  }
  EXPECT_TRUE(TryOpen().ok());
  std::filesystem::remove(floor);
  std::filesystem::create_symlink(floor, floor);
  EXPECT_EQ(TryOpen().code(), absl::StatusCode::kUnavailable);
  std::filesystem::remove(floor);
  EXPECT_TRUE(TryOpen().ok()) << "as after a restore";
}

TEST_F(OpenTest, MissingDatabaseIsCreatedOnlyIfRequested) {
  CatalogueOptions options;
  options.create_if_missing = false;
  EXPECT_TRUE(absl::IsNotFound(Catalogue::Open(database_, options).status()));
  EXPECT_FALSE(std::filesystem::exists(database_));
  OpenOrDie(database_);
  EXPECT_TRUE(Catalogue::Open(database_, options).ok());
}

TEST_F(OpenTest, TheIdStaysAndIsAnotherOneInEachDatabase) {
  const std::string id = OpenOrDie(database_)->id();
  EXPECT_TRUE(IsUuid4(id)) << id;
  MakeDatabase();
  EXPECT_EQ(OpenOrDie(database_)->id(), id);
  EXPECT_NE(OpenOrDie(directory_ / "other")->id(), id);
}

TEST_F(OpenTest, SecondOwnerInTheSameProcessIsRejected) {
  const auto owner = OpenOrDie(database_);
  const absl::Status second = TryOpen();
  EXPECT_EQ(second.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(second.message(), "the database at " + database_ +
                                  " is in use by another process; stop it or choose another --db");
  EXPECT_FALSE(HasOldLog());
  EXPECT_TRUE(owner->CreateObject(MakeObject("mug")).ok()) << "the first one is unharmed";
}

TEST_F(OpenTest, SecondOwnerInAnotherProcessIsRejectedUntilTheFirstExits) {
  ChildProcess owner("open", database_);
  ASSERT_EQ(owner.NextRevision(), 0);
  const absl::Status second = TryOpen();
  EXPECT_EQ(second.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(second.message()), HasSubstr("in use by another process"));
  EXPECT_FALSE(HasOldLog());
  owner.CloseInput();
  EXPECT_EQ(owner.Wait(), 0);
  EXPECT_TRUE(TryOpen().ok());
  EXPECT_TRUE(HasOldLog()) << "the next owner begins another file";
}

TEST_F(OpenTest, DirectoryWithOtherFilesIsUnchanged) {
  std::filesystem::create_directories(database_);
  WriteBytes(database_ + "/thesis.tex", "do not lose");
  const absl::Status opened = TryOpen();
  EXPECT_EQ(opened.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(opened.message()),
              AllOf(HasSubstr(database_), HasSubstr("not a graspdb database")));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(database_), {}), 1);
}

TEST_F(OpenTest, FileIsNotADirectory) {
  WriteBytes(database_, "text");
  EXPECT_EQ(TryOpen().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(ReadBytes(database_), "text");
}

TEST_F(OpenTest, DatabaseOfAnotherProgramIsRejected) {
  MakeForeignDatabase(database_);
  EXPECT_EQ(TryOpen().code(), absl::StatusCode::kFailedPrecondition);
  AddFamily(database_, "theirs");
  const absl::Status opened = TryOpen();
  EXPECT_EQ(opened.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(opened.message()), HasSubstr("database of another program"));
}

TEST_F(OpenTest, CrashDuringCreationIsHarmless) {
  // Before the file CURRENT ...
  std::filesystem::create_directories(database_);
  WriteBytes(database_ + "/LOCK", "");
  WriteBytes(database_ + "/LOG", "2026/01/01 started");
  WriteBytes(database_ + "/IDENTITY", "x");
  WriteBytes(database_ + "/000001.dbtmp", "half");
  EXPECT_TRUE(TryOpen().ok());
  // ... and between CURRENT and the first record, with some of the families created.
  const std::string begun = directory_ / "begun";
  MakeEmptyDatabase(begun);
  AddFamily(begun, "objects");
  const auto opened = OpenOrDie(begun);
  EXPECT_TRUE(opened->CreateObject(MakeObject("mug")).ok());
}

TEST_F(OpenTest, RecordsWithoutAMetaRecordAreNotOpened) {
  MakeDatabase();
  Tamper(database_, "default", "meta", nullptr);
  EXPECT_EQ(TryOpen().code(), absl::StatusCode::kDataLoss) << "the floor shows that it is ours";
  std::filesystem::remove(database_ + "/REVISION");
  EXPECT_EQ(TryOpen().code(), absl::StatusCode::kFailedPrecondition);
}

TEST_F(OpenTest, ARestoredDatabaseHasNoFloorAndGetsOne) {
  MakeDatabase();
  std::filesystem::remove(database_ + "/REVISION");
  EXPECT_EQ(OpenOrDie(database_)->revision(), 12);
  EXPECT_EQ(*ReadRevisionFloor(database_), 12);
}

TEST_F(OpenTest, FloorIsUpdatedWithoutAShutdown) {
  const auto catalogue = OpenOrDie(database_);
  for (int i = 0; i < 300; ++i) {
    ASSERT_TRUE(catalogue->CreateObject(MakeObject(std::to_string(i))).ok());
  }
  EXPECT_EQ(*ReadRevisionFloor(database_), 256);
}

TEST_F(OpenTest, NewerSchemaIsRejectedAndUnchanged) {
  MakeDatabase();
  SetSchemaVersion(database_, kSchemaVersion + 1);
  AddFamily(database_, "of_the_future");
  for (int attempt = 0; attempt < 2; ++attempt) {
    const absl::Status opened = TryOpen();
    EXPECT_EQ(opened.code(), absl::StatusCode::kFailedPrecondition);
    EXPECT_THAT(std::string(opened.message()),
                AllOf(HasSubstr("has schema version " + std::to_string(kSchemaVersion + 1) +
                                "; this program supports up to " + std::to_string(kSchemaVersion)),
                      HasSubstr("start the newer program")));
  }
}

TEST_F(OpenTest, SchemaVersion0IsRejectedAndUnchanged) {
  MakeDatabase();
  SetSchemaVersion(database_, 0);
  const absl::Status opened = TryOpen();
  EXPECT_EQ(opened.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(opened.message()),
              AllOf(HasSubstr("has schema version 0"), HasSubstr("import it into an empty")));
  SetSchemaVersion(database_, kSchemaVersion);
  EXPECT_EQ(OpenOrDie(database_)->revision(), 12);
}

TEST_F(OpenTest, InvalidMetaRecordIsDataLoss) {
  MakeDatabase();
  const std::string garbage = "\x0a\xff\xff";
  Tamper(database_, "default", "meta", &garbage);
  EXPECT_EQ(TryOpen().code(), absl::StatusCode::kDataLoss);
}

TEST_F(OpenTest, AMissingLastChangeRecordIsDataLoss) {
  MakeDatabase();
  Tamper(database_, "changes", std::string("\0\0\0\0\0\0\0\x0c", 8), nullptr);
  EXPECT_EQ(TryOpen().code(), absl::StatusCode::kDataLoss);
}

TEST_F(OpenTest, AMissingChangeRecordInTheMiddleIsDataLossWhenRead) {
  MakeDatabase();
  Tamper(database_, "changes", std::string("\0\0\0\0\0\0\0\x05", 8), nullptr);
  const auto catalogue = OpenOrDie(database_);
  EXPECT_EQ(catalogue->ReadChanges(0, 100).status().code(), absl::StatusCode::kDataLoss);
  EXPECT_TRUE(catalogue->ReadChanges(5, 100).ok());
}

TEST_F(OpenTest, ARecordUnderAnotherNameIsDataLossWhenRead) {
  MakeDatabase();
  const std::string bowl = MakeObject("bowl").SerializeAsString();
  Tamper(database_, "objects", "objects/mug", &bowl);
  const auto catalogue = OpenOrDie(database_);
  EXPECT_EQ(catalogue->GetObject("objects/mug").status().code(), absl::StatusCode::kDataLoss);
  EXPECT_EQ(catalogue->ListObjects(9, "").status().code(), absl::StatusCode::kDataLoss);
}

TEST_F(OpenTest, AViewWithoutItsCloudIsDataLossWhenRead) {
  MakeDatabase();
  const std::string view = "objects/mug/stablePoses/upright/views/1";
  Tamper(database_, "clouds", view, nullptr);
  const auto catalogue = OpenOrDie(database_);
  EXPECT_EQ(catalogue->GetPackedCloud(view).status().code(), absl::StatusCode::kDataLoss);
}

TEST_F(OpenTest, ACloseLeavesNoLargeLogToReplay) {
  constexpr std::size_t kLarge = 2'000'000;
  MakeDatabase();
  {
    const auto catalogue = OpenOrDie(database_);
    EXPECT_TRUE(
        catalogue->PutView(MakeView("objects/mug/stablePoses/upright/views/big", 9, kLarge)).ok());
  }
  std::uintmax_t bytes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(database_)) {
    if (entry.path().extension() == ".log") bytes += entry.file_size();
  }
  EXPECT_EQ(bytes, 0U);
  EXPECT_TRUE(
      OpenOrDie(database_)->GetPackedCloud("objects/mug/stablePoses/upright/views/big").ok());
}

TEST_F(OpenTest, IndexFilesOfEarlierVersionsAreDeleted) {
  MakeDatabase();
  const std::filesystem::path database = database_;
  const auto names = {"INDEX", "INDEX.dbtmp", "INDEX.flann", "INDEX.flann.dbtmp"};
  for (const char* name : names) WriteBytes(database / name, "GIX");
  EXPECT_EQ(OpenOrDie(database_)->revision(), 12);
  for (const char* name : names) EXPECT_FALSE(std::filesystem::exists(database / name)) << name;
}

}  // namespace
}  // namespace graspdb::storage
