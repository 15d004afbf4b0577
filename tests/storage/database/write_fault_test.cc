// A disk that fails for a while: it is reported, and writes succeed again without a restart.
#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "storage/catalogue/catalogue.h"
#include "tests/storage/catalogue_fixture.h"
#include "tests/storage/faulty_disk.h"

namespace graspdb::storage {
namespace {

using ::testing::HasSubstr;

class WriteFaultTest : public ::testing::Test {
 protected:
  void SetUp() override {
    // No flush runs when the disk begins to fail.
    Open(16U << 20);
    ASSERT_TRUE(catalogue_->CreateObject(MakeObject("mug")).ok());
    ASSERT_TRUE(catalogue_->CreateStablePose(MakeStablePose("mug", "upright")).ok());
  }
  void Open(std::size_t write_buffer_bytes) {
    CatalogueOptions options;
    options.env = env_.get();
    options.write_buffer_bytes = write_buffer_bytes;
    catalogue_ = OpenOrDie(database_, options);
  }
  absl::Status Put(int number) {
    const std::string name = "objects/mug/stablePoses/upright/views/" + std::to_string(number);
    return catalogue_->PutView(MakeView(name, number, 9000)).status();
  }
  // Puts views until one fails, and returns its error; counts `number` up.
  absl::Status PutUntilOneFails(int& number) {
    for (;; ++number) {
      if (absl::Status put = Put(number); !put.ok()) return put;
    }
  }
  WriteFault Fault() const { return catalogue_->database_status().write_fault; }
  // As the server does, each second.
  void CheckUntil(bool ok) {
    catalogue_->CheckWrites();
    while (Fault().error.ok() != ok) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      catalogue_->CheckWrites();
    }
  }

  TemporaryDirectory directory_;
  const std::string database_ = directory_ / "db";
  const std::shared_ptr<FaultyDisk> disk_ = std::make_shared<FaultyDisk>();
  const std::unique_ptr<rocksdb::Env> env_ = rocksdb::NewCompositeEnv(disk_);
  std::unique_ptr<Catalogue> catalogue_;
};

TEST_F(WriteFaultTest, AReadOnlyFileSystemIsReportedAndWritesGoOnOnceItIsWritable) {
  int number = 0;
  for (int round = 0; round < 6; ++round) {
    for (const int last = number + 3 * round; number < last; ++number)
      ASSERT_TRUE(Put(number).ok());
    disk_->FailFiles(true);
    const absl::Status failed = PutUntilOneFails(number);
    EXPECT_TRUE(absl::IsUnavailable(failed)) << failed;
    EXPECT_THAT(std::string(failed.message()), HasSubstr("Read-only file system"));
    EXPECT_TRUE(absl::IsUnavailable(Fault().error)) << Fault().error;
    const absl::Time begin = Fault().begin;
    catalogue_->CheckWrites();
    EXPECT_TRUE(absl::IsUnavailable(Fault().error)) << Fault().error;
    EXPECT_EQ(Fault().begin, begin);
    EXPECT_TRUE(TakePicture(*catalogue_).ok()) << "reads go on";

    disk_->FailFiles(false);
    CheckUntil(true);
    const absl::Status put = Put(number++);
    ASSERT_TRUE(put.ok()) << put;
  }
  EXPECT_EQ(catalogue_->revision(), 2 + number);
  const auto written = TakePicture(*catalogue_);
  ASSERT_TRUE(written.ok()) << written.status();
  catalogue_.reset();
  disk_->LosePower(database_);
  EXPECT_EQ(*TakePicture(*OpenOrDie(database_)), *written);
}

TEST_F(WriteFaultTest, IsFoundWithoutAWrite) {
  disk_->FailFiles(true);
  EXPECT_TRUE(Fault().error.ok());
  CheckUntil(false);
  EXPECT_THAT(std::string(Fault().error.message()), HasSubstr("Read-only file system"));
  disk_->FailFiles(false);
  CheckUntil(true);
  EXPECT_TRUE(Put(0).ok());
}

TEST_F(WriteFaultTest, FlushesThatFailInTheMiddleAreRepeated) {
  catalogue_.reset();
  Open(64U << 10);
  int number = 0;
  for (int round = 0; round < 3; ++round) {
    disk_->FailSortedFiles(1, /*is_full=*/false);
    ASSERT_FALSE(PutUntilOneFails(number).ok());
    CheckUntil(true);
    EXPECT_TRUE(Put(number++).ok());
  }
  const auto written = TakePicture(*catalogue_);
  catalogue_.reset();
  disk_->LosePower(database_);
  EXPECT_EQ(*TakePicture(*OpenOrDie(database_)), *written);
}

TEST_F(WriteFaultTest, NothingIsWrittenToAnotherFolderInItsPlace) {
  ASSERT_TRUE(Put(0).ok());
  disk_->FailFiles(true);
  int number = 1;
  ASSERT_FALSE(PutUntilOneFails(number).ok());
  std::filesystem::rename(database_, directory_ / "moved");
  std::filesystem::create_directory(database_);
  disk_->FailFiles(false);
  const auto again = std::chrono::steady_clock::now() + std::chrono::milliseconds(1500);
  while (std::chrono::steady_clock::now() < again) catalogue_->CheckWrites();
  EXPECT_THAT(std::string(Fault().error.message()), HasSubstr("another folder is in the place"));
  EXPECT_FALSE(Put(number).ok());
  EXPECT_TRUE(std::filesystem::is_empty(database_));
  std::filesystem::remove(database_);
  std::filesystem::rename(directory_ / "moved", database_);
  CheckUntil(true);
  EXPECT_TRUE(Put(number).ok());
}

}  // namespace
}  // namespace graspdb::storage
