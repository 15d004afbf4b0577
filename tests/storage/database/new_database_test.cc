// Databases that an open creates: empty, with durable names.
#include <cerrno>
#include <filesystem>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "storage/catalogue/catalogue.h"
#include "storage/changes/schema.h"
#include "tests/storage/catalogue_fixture.h"
#include "tests/testing/unreadable_folder.h"
#include "tests/testing/watched_syncs.h"

namespace graspdb::storage {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class NewDatabaseTest : public ::testing::Test {
 protected:
  absl::Status TryOpen() { return Catalogue::Open(database_).status(); }

  TemporaryDirectory directory_;
  const std::string database_ = directory_ / "db";
};

TEST_F(NewDatabaseTest, ANewDatabaseIsEmpty) {
  const WatchedSyncs syncs;
  const auto catalogue = OpenOrDie(directory_ / "some/where/deep");
  for (const char* durable : {"", "some", "some/where", "some/where/deep"}) {
    EXPECT_TRUE(syncs.Flushed(directory_ / durable)) << durable;
  }
  EXPECT_EQ(catalogue->revision(), 0);
  EXPECT_EQ(catalogue->schema_version(), kSchemaVersion);
  const auto picture = TakePicture(*catalogue);
  ASSERT_TRUE(picture.ok());
  EXPECT_EQ(*picture, Picture());
}

TEST_F(NewDatabaseTest, ANewDatabaseIsRefusedWhereItsNameCannotBeFlushed) {
  const UnreadableFolder unreadable(directory_.path());
  const absl::Status status = TryOpen();
  EXPECT_EQ(status.code(), absl::StatusCode::kUnavailable);
  EXPECT_THAT(std::string(status.message()), AllOf(HasSubstr(database_), HasSubstr("permissions")));
  EXPECT_EQ(TryOpen(), status) << "a server that is started again";
}

// A start that was killed may have made the folder without flushing its name.
TEST_F(NewDatabaseTest, ANewDatabaseInAFolderThatExistsHasADurableName) {
  for (const char* path : {"empty", "slash", "some/where"}) {
    std::filesystem::create_directories(directory_ / path);
  }
  std::filesystem::create_directory_symlink(directory_ / "some/where", directory_ / "link");
  const auto flushes = [this](const char* database, const char* above) {
    const WatchedSyncs syncs;
    OpenOrDie(directory_ / database);
    return syncs.Flushed(directory_ / above);
  };
  EXPECT_TRUE(flushes("empty", ""));
  EXPECT_TRUE(flushes("slash/", ""));
  EXPECT_TRUE(flushes("link", "some"));
}

TEST_F(NewDatabaseTest, ANewDatabaseMayBeInAFolderThatExistsBelowOneThatCannotBeRead) {
  std::filesystem::create_directory(database_);
  const UnreadableFolder unreadable(directory_.path());
  EXPECT_EQ(TryOpen(), absl::OkStatus());
}

TEST_F(NewDatabaseTest, ANewDatabaseIsRefusedWhereTheNameOfItsFolderFailsToBeFlushed) {
  std::filesystem::create_directory(database_);
  WatchedSyncs syncs;
  syncs.FailFolders(EIO);
  EXPECT_EQ(TryOpen().code(), absl::StatusCode::kUnavailable);
  EXPECT_TRUE(std::filesystem::is_empty(database_));
}

}  // namespace
}  // namespace graspdb::storage
