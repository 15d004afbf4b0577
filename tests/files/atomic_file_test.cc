#include "files/base/atomic_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <string>

#include "tests/files/temporary_folder.h"
#include "tests/testing/unreadable_folder.h"
#include "tests/testing/watched_syncs.h"

namespace graspdb::files {
namespace {

TEST(AtomicFile, MakesFoldersAndReplacesWithoutLeavingAnythingBehind) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "a" / "b" / "file";
  ASSERT_TRUE(WriteFileAtomically(path, "old and longer", Durability::kPowerFailure).ok());
  ASSERT_TRUE(WriteFileAtomically(path, "new", Durability::kProcessCrash).ok());
  EXPECT_EQ(BytesOf(path), "new");
  const std::filesystem::directory_iterator files(path.parent_path());
  EXPECT_EQ(std::distance(begin(files), end(files)), 1);
}

TEST(AtomicFile, AFileThatAppearsMeanwhileCanBeKept) {
  const TemporaryFolder folder;
  {
    const auto file = AtomicFile::Create(folder.path() / "file", Durability::kProcessCrash);
    ASSERT_TRUE(file.ok());
    ASSERT_TRUE((*file)->Append("new").ok());
    const auto path = folder.Write("file", "of another program");
    const absl::Status kept = (*file)->Commit(Existing::kKeep);
    EXPECT_EQ(kept.code(), absl::StatusCode::kAlreadyExists);
    EXPECT_THAT(std::string(kept.message()), testing::HasSubstr(path.string()));
    EXPECT_EQ(BytesOf(path), "of another program");
  }
  const auto other = AtomicFile::Create(folder.path() / "other", Durability::kProcessCrash);
  ASSERT_TRUE(other.ok());
  ASSERT_TRUE((*other)->Append("new").ok());
  EXPECT_TRUE((*other)->Commit(Existing::kKeep).ok());
  EXPECT_EQ(BytesOf(folder.path() / "other"), "new");
  const std::filesystem::directory_iterator files(folder.path());
  EXPECT_EQ(std::distance(begin(files), end(files)), 2) << "a temporary file was left";
}

TEST(AtomicFile, NamesAreFlushedIfTheFileMustSurviveAPowerFailure) {
  const TemporaryFolder folder;
  const WatchedSyncs syncs;
  const auto path = folder.path() / "a" / "b" / "file";
  ASSERT_TRUE(WriteFileAtomically(path, "new", Durability::kPowerFailure).ok());
  for (auto flushed = path; flushed != folder.path().parent_path();
       flushed = flushed.parent_path()) {
    EXPECT_TRUE(syncs.Flushed(flushed)) << flushed;
  }
  ASSERT_TRUE(
      WriteFileAtomically(folder.path() / "c" / "file", "x", Durability::kProcessCrash).ok());
  EXPECT_FALSE(syncs.Flushed(folder.path() / "c"));
}

TEST(AtomicFile, TheNameOfAFolderThatExistsIsFlushedToo) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.path() / "a" / "b");
  const WatchedSyncs syncs;
  const auto path = folder.path() / "a" / "b" / "file";
  ASSERT_TRUE(WriteFileAtomically(path, "new", Durability::kPowerFailure).ok());
  EXPECT_TRUE(syncs.Flushed(folder.path() / "a"));
}

TEST(AtomicFile, AFolderThatCannotBeFlushedIsAnErrorIfTheFileMustSurviveAPowerFailure) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "file";
  const auto file = AtomicFile::Create(path, Durability::kPowerFailure);
  ASSERT_TRUE(file.ok()) << file.status();
  ASSERT_TRUE((*file)->Append("new").ok());
  WatchedSyncs syncs;
  syncs.FailFolders(EIO);
  const absl::Status failed = (*file)->Commit();
  EXPECT_EQ(failed.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(failed.message()),
              testing::StartsWith(path.string() + " is written, but"));
  EXPECT_EQ(BytesOf(path), "new");
  EXPECT_FALSE(WriteFileAtomically(path, "newer", Durability::kPowerFailure).ok());
  EXPECT_EQ(BytesOf(path), "new") << "the name of its folder is flushed first";
  const auto below = folder.path() / "new" / "file";
  EXPECT_FALSE(WriteFileAtomically(below, "new", Durability::kPowerFailure).ok());
  EXPECT_FALSE(std::filesystem::exists(below)) << "its folder was made first";
  EXPECT_TRUE(WriteFileAtomically(path, "x", Durability::kProcessCrash).ok());
  syncs.FailFolders(EINVAL);  // of a file system that cannot do it
  EXPECT_TRUE(WriteFileAtomically(path, "x", Durability::kPowerFailure).ok());
}

TEST(AtomicFile, AFolderThatMayBeWrittenButNotReadTakesFiles) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "file";
  const auto below = folder.path() / "new" / "file";
  const UnreadableFolder unreadable(folder.path());
  const WatchedSyncs syncs;
  for (const auto& written : {path, below}) {
    const absl::Status status = WriteFileAtomically(written, "new", Durability::kPowerFailure);
    EXPECT_TRUE(status.ok()) << status;
    EXPECT_EQ(BytesOf(written), "new");
    EXPECT_TRUE(syncs.Flushed(written));
  }
  EXPECT_TRUE(syncs.Flushed(below.parent_path())) << "this one can be";
}

TEST(AtomicFile, DoesNotFollowALinkOfItsTemporaryName) {
  const TemporaryFolder folder;
  const auto other = folder.Write("other", "kept");
  const auto path = folder.path() / "file";
  const std::string temporary = path.string() + "." + std::to_string(getpid()) + ".tmp";
  std::filesystem::create_symlink(other, temporary);
  EXPECT_FALSE(WriteFileAtomically(path, "new", Durability::kProcessCrash).ok());
  EXPECT_EQ(BytesOf(other), "kept");
}

TEST(AtomicFile, FailureNamesThePathAndLeavesTheOldFile) {
  const TemporaryFolder folder;
  const auto file = folder.Write("file", "old");
  const absl::Status below_a_file =
      WriteFileAtomically(file / "child", "x", Durability::kProcessCrash);
  EXPECT_THAT(std::string(below_a_file.message()), testing::HasSubstr((file / "child").string()));
  EXPECT_EQ(below_a_file.code(), absl::StatusCode::kFailedPrecondition) << "no server is missing";
  EXPECT_EQ(BytesOf(file), "old");

  std::filesystem::create_directories(folder.path() / "taken" / "inside");
  EXPECT_FALSE(WriteFileAtomically(folder.path() / "taken", "x", Durability::kProcessCrash).ok());
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "taken" / "inside"));
  const std::filesystem::directory_iterator files(folder.path());
  EXPECT_EQ(std::distance(begin(files), end(files)), 2) << "a temporary file was left";
}

}  // namespace
}  // namespace graspdb::files
