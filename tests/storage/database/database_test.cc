// The database below the catalogue, on a full disk.
#include "storage/database/database.h"

#include <chrono>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/storage/catalogue_fixture.h"
#include "tests/storage/faulty_disk.h"

namespace graspdb::storage {
namespace {

class DatabaseTest : public ::testing::Test {
 protected:
  void Open() {
    database_.reset();
    Database::Options options;
    options.write_buffer_bytes = 64U << 10;
    options.env = env_.get();
    auto opened = Database::Open(directory_ / "db", options);
    ASSERT_TRUE(opened.ok()) << opened.status();
    database_ = *std::move(opened);
    ASSERT_TRUE(database_->CreateMissingFamilies().ok());
  }
  // Two rows: sorted files of one row are moved in place of being compacted.
  absl::Status Write(Family family, std::string_view value) {
    rocksdb::WriteBatch batch;
    absl::Status put = database_->Put(family, "row", value, batch);
    put.Update(database_->Put(family, "second row", value, batch));
    return put.ok() ? database_->Write(batch) : put;
  }

  TemporaryDirectory directory_;
  const std::shared_ptr<FaultyDisk> disk_ = std::make_shared<FaultyDisk>();
  const std::unique_ptr<rocksdb::Env> env_ = rocksdb::NewCompositeEnv(disk_);
  std::unique_ptr<Database> database_;
};

TEST_F(DatabaseTest, WritesAndFlushesDoNotWaitForCompactionsThatFindTheDiskFull) {
  ASSERT_NO_FATAL_FAILURE(Open());
  disk_->FailCompactions(true);
  // Each flush leaves a sorted file. Compactions begin with four; by default RocksDB delays flushes
  // and writes from 20 on, and stops writes with 36.
  for (int flush = 1; flush <= 45; ++flush) {
    ASSERT_TRUE(Write(Family::kObjects, std::to_string(flush)).ok());
    const absl::Status flushed = database_->Flush();
    ASSERT_TRUE(flushed.ok()) << flushed;
    while (flush == 4 && disk_->failed_compactions() == 0) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
}

TEST_F(DatabaseTest, WritesSucceedOnceThereIsPlaceForANewLog) {
  ASSERT_NO_FATAL_FAILURE(Open());
  disk_->FailNewLogs(true);
  const std::string value(1000, 'x');
  absl::Status written;
  // Until the memtable of the family is full. One family: RocksDB leaks references of the others.
  while (written.ok()) written = Write(Family::kMeta, value);
  EXPECT_TRUE(absl::IsResourceExhausted(written)) << written;
  disk_->FailNewLogs(false);
  absl::Status again = Write(Family::kMeta, value);
  while (absl::IsResourceExhausted(again)) again = Write(Family::kMeta, value);
  EXPECT_TRUE(again.ok()) << again;
  ASSERT_NO_FATAL_FAILURE(Open());
  EXPECT_EQ(*database_->Get(Family::kMeta, "row"), value);
  EXPECT_TRUE(Write(Family::kMeta, value).ok());
}

}  // namespace
}  // namespace graspdb::storage
