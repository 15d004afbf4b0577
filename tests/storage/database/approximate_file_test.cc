#include "storage/database/approximate_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/files/temporary_folder.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::storage {
namespace {

using testing::IsOk;
using testing::StatusIs;

class ApproximateFileTest : public ::testing::Test {
 protected:
  ApproximateFileTest() {
    record_.set_library("a library");
    record_.add_names("objects/a");
    record_.add_means(0.5F);
    record_.set_tree(std::string(100, '\x07'));
  }

  std::string Folder() const { return folder_.path().string(); }
  std::string Path() const { return Folder() + "/" + std::string(kApproximateFile); }

  std::string Bytes() const {
    std::ifstream file(Path(), std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  absl::Status ReadOf(const std::string& bytes) const {
    std::ofstream(Path(), std::ios::binary) << bytes;
    return ReadApproximateFile(Folder()).status();
  }

  const files::TemporaryFolder folder_;
  ApproximateIndexRecord record_;
};

TEST_F(ApproximateFileTest, WhatIsWrittenIsRead) {
  EXPECT_THAT(ReadApproximateFile(Folder()), StatusIs(absl::StatusCode::kNotFound));
  ASSERT_THAT(WriteApproximateFile(Folder(), record_), IsOk());
  const auto read = ReadApproximateFile(Folder());
  ASSERT_THAT(read, IsOk());
  EXPECT_EQ(read->SerializeAsString(), record_.SerializeAsString());
}

TEST_F(ApproximateFileTest, AllDamageIsDetected) {
  ASSERT_THAT(WriteApproximateFile(Folder(), record_), IsOk());
  const std::string bytes = Bytes();
  ASSERT_THAT(ReadOf(bytes), IsOk());
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::string damaged = bytes;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
    EXPECT_THAT(ReadOf(damaged), StatusIs(absl::StatusCode::kDataLoss)) << i;
    EXPECT_THAT(ReadOf(bytes.substr(0, i)), StatusIs(absl::StatusCode::kDataLoss)) << i;
  }
  EXPECT_THAT(ReadOf(bytes + "x"), StatusIs(absl::StatusCode::kDataLoss));
}

TEST_F(ApproximateFileTest, AFileThatCannotBeReadIsNotDamaged) {
  std::filesystem::create_symlink(Path(), Path());
  EXPECT_THAT(ReadApproximateFile(Folder()),
              StatusIs(absl::StatusCode::kUnavailable, ::testing::HasSubstr(Path())));
}

TEST_F(ApproximateFileTest, RemainsOfACrashAreOverwritten) {
  std::ofstream(Path() + ".dbtmp", std::ios::binary) << std::string(10'000, 'x');
  ASSERT_THAT(WriteApproximateFile(Folder(), record_), IsOk());
  EXPECT_THAT(ReadApproximateFile(Folder()), IsOk());
  EXPECT_FALSE(std::filesystem::exists(Path() + ".dbtmp"));
}

TEST_F(ApproximateFileTest, DiskFailureIsReportedAndLeavesTheOldFile) {
  ASSERT_THAT(WriteApproximateFile(Folder(), record_), IsOk());
  const std::string bytes = Bytes();
  std::filesystem::create_directory(Path() + ".dbtmp");
  record_.set_library("another library");
  EXPECT_THAT(WriteApproximateFile(Folder(), record_),
              StatusIs(absl::StatusCode::kUnavailable, ::testing::HasSubstr(Path())));
  EXPECT_EQ(Bytes(), bytes);
}

}  // namespace
}  // namespace graspdb::storage
