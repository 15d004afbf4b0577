#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <filesystem>
#include <string>

#include "files/capture_sets/capture_set.h"
#include "tests/files/temporary_folder.h"
#include "tests/testing/watched_syncs.h"

namespace graspdb::files {
namespace {

class CaptureSetWriterTest : public testing::Test {
 protected:
  static PointFile Cloud() {
    PointFile file;
    file.points.emplace_back(0.1F, 0.2F, 0.7F);
    file.width = 1;
    file.height = 1;
    return file;
  }
  absl::Status Add(const std::string& path) {
    set_.add_captures()->set_path(path);
    return writer_.AddCloud(path, Cloud());
  }

  const TemporaryFolder folder_;
  const std::filesystem::path written_ = folder_.path() / "captures" / "monday";
  CaptureSetWriter writer_{written_};
  v1::CaptureSet set_;
};

TEST_F(CaptureSetWriterTest, EverythingIsOnTheDiskAtTheEnd) {
  const WatchedSyncs syncs;
  for (const char* path : {"clouds/mug/a.pcd", "clouds/mug/b.pcd", "clouds/can/a.pcd"}) {
    const absl::Status added = Add(path);
    ASSERT_TRUE(added.ok()) << added;
    EXPECT_TRUE(syncs.Flushed(written_ / path)) << path;
    EXPECT_FALSE(syncs.Flushed((written_ / path).parent_path())) << "it waits for each name";
  }
  const absl::Status finished = writer_.Finish(set_);
  ASSERT_TRUE(finished.ok()) << finished;
  for (const char* path : {"clouds/mug", "clouds/can", "clouds", "captures.json", ""}) {
    EXPECT_TRUE(syncs.Flushed(written_ / path)) << path;
  }
  EXPECT_TRUE(syncs.Flushed(written_.parent_path()));
  EXPECT_TRUE(syncs.Flushed(folder_.path()));
}

TEST_F(CaptureSetWriterTest, CloudsThatAreNotOnTheDiskAreNotDescribed) {
  const absl::Status added = Add("clouds/mug/a.pcd");
  ASSERT_TRUE(added.ok()) << added;
  WatchedSyncs syncs;
  syncs.FailFolders(EIO);
  const absl::Status failed = writer_.Finish(set_);
  EXPECT_EQ(failed.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(failed.message()),
              testing::HasSubstr("cannot flush the folder " + (written_ / "clouds/mug").string()));
  EXPECT_FALSE(std::filesystem::exists(written_ / "captures.json"));
}

TEST_F(CaptureSetWriterTest, ACloudThatFailsToBeFlushedIsAnErrorAndIsNotThere) {
  WatchedSyncs syncs;
  syncs.FailFiles(EIO);
  EXPECT_EQ(Add("clouds/mug/a.pcd").code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_TRUE(std::filesystem::is_empty(written_ / "clouds/mug"));
}

TEST_F(CaptureSetWriterTest, AFolderThatCannotBeMadeIsAnErrorWithItsPath) {
  folder_.Write("captures", "a file");
  const absl::Status failed = Add("clouds/mug/a.pcd");
  EXPECT_EQ(failed.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(failed.message()),
              testing::HasSubstr("cannot make the folder " + (written_ / "clouds/mug").string()));
}

TEST_F(CaptureSetWriterTest, ASetWithoutCloudsHasItsDescription) {
  const absl::Status finished = writer_.Finish(set_);
  EXPECT_TRUE(finished.ok()) << finished;
  EXPECT_TRUE(std::filesystem::exists(written_ / "captures.json"));
}

}  // namespace
}  // namespace graspdb::files
