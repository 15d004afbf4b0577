// The file beside the database: reading gives the written contents, or an error.
#include "storage/index_file.h"

#include <filesystem>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/storage/catalogue_fixture.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::storage {
namespace {

using graspdb::testing::IsOk;
using graspdb::testing::StatusIs;

constexpr auto kDataLoss = absl::StatusCode::kDataLoss;

IndexBlock BlockOf(const std::string& name) {
  IndexBlock block;
  block.add_names(name);
  block.add_bins(0.5F);
  return block;
}

class IndexFileTest : public ::testing::Test {
 protected:
  absl::Status WriteFile(const std::string& mark, std::int64_t block_count = 2) const {
    IndexHeader header;
    header.set_mark(mark);
    header.set_block_count(block_count);
    IndexFileWriter file(directory_.path(), header);
    for (const char* name : {"a", "b"}) {
      if (auto added = file.Append(BlockOf(name)); !added.ok()) return added;
    }
    return file.Commit();
  }

  // The mark and the names of all blocks, if the file is valid.
  absl::StatusOr<std::string> ReadFile() const {
    auto file = IndexFileReader::Open(directory_.path());
    if (!file.ok()) return file.status();
    std::string out = file->header().mark();
    IndexBlock block;
    for (std::int64_t i = 0; i < file->header().block_count(); ++i) {
      if (auto read = file->Next(&block); !read.ok()) return read;
      out += " " + block.names(0);
    }
    if (auto finished = file->Finish(); !finished.ok()) return finished;
    return out;
  }

  const TemporaryDirectory directory_;
  const std::string path_ = directory_ / kIndexFile;
};

TEST_F(IndexFileTest, WhatIsWrittenIsRead) {
  ASSERT_THAT(WriteFile("mark"), IsOk());
  const auto read = ReadFile();
  ASSERT_THAT(read, IsOk());
  EXPECT_EQ(*read, "mark a b");
}

TEST_F(IndexFileTest, MissingFileIsNotFound) {
  EXPECT_THAT(ReadFile(), StatusIs(absl::StatusCode::kNotFound, ::testing::_));
}

TEST_F(IndexFileTest, TruncationIsDetectedEverywhere) {
  ASSERT_THAT(WriteFile("mark"), IsOk());
  const std::string bytes = ReadBytes(path_);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    WriteBytes(path_, bytes.substr(0, size));
    EXPECT_THAT(ReadFile(), StatusIs(kDataLoss, ::testing::_)) << size;
  }
}

TEST_F(IndexFileTest, FlippedBitIsDetectedEverywhere) {
  ASSERT_THAT(WriteFile("mark"), IsOk());
  const std::string bytes = ReadBytes(path_);
  for (std::size_t i = 0; i < 8 * bytes.size(); ++i) {
    std::string flipped = bytes;
    flipped[i / 8] = static_cast<char>(flipped[i / 8] ^ (1 << (i % 8)));
    WriteBytes(path_, flipped);
    EXPECT_THAT(ReadFile(), StatusIs(kDataLoss, ::testing::_)) << i;
  }
}

TEST_F(IndexFileTest, TrailingBytesAreDetected) {
  ASSERT_THAT(WriteFile("mark"), IsOk());
  WriteBytes(path_, ReadBytes(path_) + '\0');
  EXPECT_THAT(ReadFile(), StatusIs(kDataLoss, ::testing::_));
}

TEST_F(IndexFileTest, SwappedBlocksAreDetected) {
  ASSERT_THAT(WriteFile("mark"), IsOk());
  const std::string bytes = ReadBytes(path_);
  const std::size_t size = 8 + BlockOf("a").SerializeAsString().size();
  const std::size_t first = bytes.size() - 2 * size;
  WriteBytes(path_,
             bytes.substr(0, first) + bytes.substr(first + size) + bytes.substr(first, size));
  EXPECT_THAT(ReadFile(), StatusIs(kDataLoss, ::testing::_));
}

TEST_F(IndexFileTest, UnfinishedWriterLeavesTheOldFile) {
  ASSERT_THAT(WriteFile("old"), IsOk());
  EXPECT_THAT(WriteFile("new", 3), StatusIs(absl::StatusCode::kFailedPrecondition, ::testing::_));
  EXPECT_EQ(*ReadFile(), "old a b");
  EXPECT_FALSE(std::filesystem::exists(path_ + ".dbtmp"));
}

TEST_F(IndexFileTest, RemainsOfACrashAreOverwritten) {
  WriteBytes(path_ + ".dbtmp", std::string(10'000, 'x'));
  ASSERT_THAT(WriteFile("new"), IsOk());
  EXPECT_EQ(*ReadFile(), "new a b");
}

TEST_F(IndexFileTest, DiskFailureIsReportedAndLeavesTheOldFile) {
  ASSERT_THAT(WriteFile("old"), IsOk());
  std::filesystem::create_directory(path_ + ".dbtmp");
  EXPECT_THAT(WriteFile("new"),
              StatusIs(absl::StatusCode::kUnavailable, ::testing::HasSubstr(path_)));
  EXPECT_EQ(*ReadFile(), "old a b");
}

}  // namespace
}  // namespace graspdb::storage
