// Files of other programs are read up to a limit.
#include "program/text/read_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <thread>

#include "tests/files/temporary_folder.h"
#include "tests/testing/status_matchers.h"

namespace graspdb {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::StatusIs;

class ReadFileTest : public ::testing::Test {
 protected:
  std::filesystem::path Write(const std::string& bytes) const {
    std::ofstream(path_, std::ios::binary) << bytes;
    return path_;
  }

  files::TemporaryFolder folder_;
  const std::filesystem::path path_ = folder_.path() / "file";
};

TEST_F(ReadFileTest, GivesAllBytesUpToTheLimit) {
  for (const std::size_t size : {0UL, 1UL, 65536UL, 65537UL, 1UL << 20}) {
    std::string bytes(size, 'a');
    if (size > 0) bytes.back() = '\0';
    const auto read = ReadFile(Write(bytes), 1 << 20);
    ASSERT_THAT(read, IsOk());
    EXPECT_EQ(*read, bytes);
  }
}

TEST_F(ReadFileTest, ALargerFileIsRefused) {
  EXPECT_THAT(ReadFile(Write(std::string((1 << 20) + 1, 'a')), 1 << 20).status(),
              StatusIs(absl::StatusCode::kInvalidArgument,
                       AllOf(HasSubstr(path_.string()), HasSubstr("larger than 1 MiB"))));
}

// It claims no size, and has no end.
TEST_F(ReadFileTest, ADeviceWithoutEndIsRefused) {
  EXPECT_THAT(ReadFile("/dev/zero", 1 << 20).status(),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("larger than 1 MiB")));
}

TEST_F(ReadFileTest, APipeIsReadToItsEnd) {
  ASSERT_EQ(mkfifo(path_.c_str(), 0600), 0);
  std::thread writer([&] { Write(std::string(200000, 'a')); });
  const auto read = ReadFile(path_, 1 << 20);
  writer.join();
  ASSERT_THAT(read, IsOk());
  EXPECT_EQ(read->size(), 200000);
}

TEST_F(ReadFileTest, WhatCannotBeReadHasItsReason) {
  EXPECT_THAT(ReadFile(path_, 1 << 20).status(),
              StatusIs(absl::StatusCode::kNotFound, HasSubstr("does not exist")));
  EXPECT_THAT(ReadFile(folder_.path(), 1 << 20).status(),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("Is a directory")));
}

TEST_F(ReadFileTest, ATextLosesItsByteOrderMark) {
  const auto read = ReadTextFile(Write("\xEF\xBB\xBF{}"), 1 << 20);
  ASSERT_THAT(read, IsOk());
  EXPECT_EQ(*read, "{}");
  EXPECT_THAT(ReadTextFile(Write(std::string("\xFF\xFE{\0}\0", 6)), 1 << 20).status(),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("UTF-16")));
}

}  // namespace
}  // namespace graspdb
