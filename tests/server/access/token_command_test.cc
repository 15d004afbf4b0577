// The file of `graspdb-server token`.
#include "server/access/token_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/files/temporary_folder.h"
#include "tests/testing/unreadable_folder.h"
#include "tests/testing/watched_syncs.h"

namespace graspdb::server {
namespace {

class TokenCommandTest : public ::testing::Test {
 protected:
  int Run() const {
    std::vector<std::string> words = {"token", "press-3", "--role", "read", "--out", path_};
    std::vector<char*> argv;
    argv.reserve(words.size());
    for (std::string& word : words) argv.push_back(word.data());
    return RunTokenCommand(static_cast<int>(argv.size()), argv.data());
  }

  const files::TemporaryFolder folder_;
  const std::string path_ = (folder_.path() / "press-3.token").string();
};

TEST_F(TokenCommandTest, TheTokenIsOnTheDisk) {
  const WatchedSyncs syncs;
  EXPECT_EQ(Run(), 0);
  EXPECT_THAT(files::BytesOf(path_), ::testing::StartsWith("graspdb_"));
  EXPECT_TRUE(syncs.Flushed(path_));
  EXPECT_TRUE(syncs.Flushed(folder_.path()));
}

TEST_F(TokenCommandTest, TheFolderMayBeWrittenButNotRead) {
  const UnreadableFolder unreadable(folder_.path());
  EXPECT_EQ(Run(), 0);
  EXPECT_THAT(files::BytesOf(path_), ::testing::StartsWith("graspdb_"));
}

TEST_F(TokenCommandTest, AnExistingFileIsKeptAndTheErrorHasAdvice) {
  folder_.Write("press-3.token", "kept");
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(Run(), 1);
  EXPECT_THAT(::testing::internal::GetCapturedStderr(),
              ::testing::EndsWith(" (File exists); choose another file, or move this one away\n"));
  EXPECT_EQ(files::BytesOf(path_), "kept");
}

TEST_F(TokenCommandTest, AFailingDiskIsAnErrorAndLeavesNoFile) {
  {
    WatchedSyncs syncs;
    syncs.FailFiles(EIO);
    EXPECT_EQ(Run(), 1);
    EXPECT_FALSE(std::filesystem::exists(path_));
  }
  {
    WatchedSyncs syncs;
    syncs.FailFolders(EIO);
    EXPECT_EQ(Run(), 1);
    EXPECT_FALSE(std::filesystem::exists(path_));
  }
  EXPECT_EQ(Run(), 0) << "the name is free";
}

}  // namespace
}  // namespace graspdb::server
