// A full disk: writes are rejected, reads go on, and writes succeed again once there is room.
#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "storage/backups/backups.h"
#include "storage/catalogue/catalogue.h"
#include "storage/uploads/uploads.h"
#include "tests/storage/catalogue_fixture.h"
#include "tests/storage/faulty_disk.h"

namespace graspdb::storage {
namespace {

using ::testing::HasSubstr;

// As storage/database/database.cc waits between its attempts.
constexpr std::chrono::milliseconds kBetweenRecoveries{1050};

class DiskFullTest : public ::testing::Test {
 protected:
  std::unique_ptr<Catalogue> Open() {
    CatalogueOptions options;
    options.env = env_.get();
    options.write_buffer_bytes = write_buffer_bytes_;
    return OpenOrDie(database_, options);
  }
  static NewView View(int number) {
    return MakeView("objects/mug/stablePoses/upright/views/" + std::to_string(number), number,
                    9000);
  }
  static void Prepare(Catalogue& catalogue) {
    ASSERT_TRUE(catalogue.CreateObject(MakeObject("mug")).ok());
    ASSERT_TRUE(catalogue.CreateStablePose(MakeStablePose("mug", "upright")).ok());
  }
  // Repeats a call until it does not find the disk full.
  template <typename Call>
  static absl::Status Repeat(const Call& call) {
    for (;;) {
      absl::Status status = call();
      if (!absl::IsResourceExhausted(status)) return status;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }
  // Views enough to fill memtables twice, each until the disk is not full; counts `number` up.
  static void PutMore(Catalogue& catalogue, int& number) {
    for (const int last = number + 20; number < last; ++number) {
      const absl::Status put = Repeat([&] { return catalogue.PutView(View(number)).status(); });
      ASSERT_TRUE(put.ok()) << put;
    }
  }
  // Whether a copy that is taken now has every acknowledged write, with and without the unsynced
  // bytes.
  void ExpectDurable(const Catalogue& catalogue) {
    for (const auto unsynced : {FaultyDisk::Unsynced::kKept, FaultyDisk::Unsynced::kLost}) {
      disk_->CopyOpen(database_, copy_, unsynced);
      const auto recovered = TakePicture(*OpenOrDie(copy_));
      ASSERT_TRUE(recovered.ok()) << recovered.status();
      EXPECT_EQ(*recovered, *TakePicture(catalogue));
    }
  }
  // The same where compactions delete files: nothing is copied while they do.
  void ExpectDurableWhenClosed(std::unique_ptr<Catalogue> catalogue) {
    const auto written = TakePicture(*catalogue);
    catalogue.reset();
    CopyDatabase(database_, copy_);
    disk_->LosePower(copy_);
    const auto recovered = TakePicture(*OpenOrDie(copy_));
    ASSERT_TRUE(recovered.ok()) << recovered.status();
    EXPECT_EQ(*recovered, *written);
  }

  TemporaryDirectory directory_;
  const std::string database_ = directory_ / "db";
  const std::string copy_ = directory_ / "copy";
  std::size_t write_buffer_bytes_ = 16U << 20;
  const std::shared_ptr<FaultyDisk> disk_ = std::make_shared<FaultyDisk>();
  const std::unique_ptr<rocksdb::Env> env_ = rocksdb::NewCompositeEnv(disk_);
};

TEST_F(DiskFullTest, WritesAreRejectedAndSucceedOnceThereIsRoom) {
  const auto catalogue = Open();
  Prepare(*catalogue);
  for (const std::int64_t space : {0, 1, 20, 500, 4000}) {
    const std::int64_t revision = catalogue->revision();
    const int number = static_cast<int>(revision);
    const auto before = TakePicture(*catalogue);
    disk_->SetSpace(space);
    const absl::Status full = catalogue->PutView(View(number)).status();
    ASSERT_TRUE(absl::IsResourceExhausted(full)) << full;
    EXPECT_THAT(std::string(full.message()), HasSubstr("free space on the disk"));
    EXPECT_TRUE(absl::IsResourceExhausted(catalogue->CreateCell(MakeCell("c")).status()));
    EXPECT_EQ(*TakePicture(*catalogue), *before) << "reads go on";

    disk_->SetSpace(FaultyDisk::kMuchSpace);
    const absl::Status again = Repeat([&] { return catalogue->PutView(View(number)).status(); });
    ASSERT_TRUE(again.ok()) << again;
    EXPECT_EQ(catalogue->revision(), revision + 1);
    ExpectDurable(*catalogue);
    ASSERT_TRUE(catalogue->PutView(View(1000 + number)).ok());
    ExpectDurable(*catalogue);
  }
}

TEST_F(DiskFullTest, TheFirstWriteAfterTheStartMayFindTheDiskFull) {
  Prepare(*Open());
  const auto catalogue = Open();
  disk_->SetSpace(300);
  ASSERT_TRUE(absl::IsResourceExhausted(catalogue->PutView(View(1)).status()));
  disk_->SetSpace(FaultyDisk::kMuchSpace);
  for (int number = 1; number < 4; ++number) {
    const absl::Status put = Repeat([&] { return catalogue->PutView(View(number)).status(); });
    ASSERT_TRUE(put.ok()) << put;
    ExpectDurable(*catalogue);
  }
}

TEST_F(DiskFullTest, AKillBeforeThereIsRoomLosesNothing) {
  auto catalogue = Open();
  Prepare(*catalogue);
  disk_->SetSpace(3000);
  ASSERT_TRUE(absl::IsResourceExhausted(catalogue->PutView(View(1)).status()));
  ExpectDurable(*catalogue);
  catalogue.reset();
  disk_->SetSpace(FaultyDisk::kMuchSpace);
  catalogue = Open();
  EXPECT_EQ(catalogue->revision(), 2);
  EXPECT_TRUE(catalogue->PutView(View(1)).ok());
}

// Each attempt to recover gets a little further.
TEST_F(DiskFullTest, AKillWhileThereIsTooLittleRoomLosesNothing) {
  disk_->ReportSpace(false);
  const auto catalogue = Open();
  Prepare(*catalogue);
  ASSERT_TRUE(catalogue->PutView(View(1)).ok());
  disk_->SetSpace(4000);
  absl::Status put = catalogue->PutView(View(2)).status();
  for (std::int64_t space = 50; !put.ok(); space *= 4) {
    ASSERT_TRUE(absl::IsResourceExhausted(put)) << put;
    ExpectDurable(*catalogue);
    disk_->SetSpace(space);
    std::this_thread::sleep_for(kBetweenRecoveries);
    put = catalogue->PutView(View(2)).status();
  }
  ExpectDurable(*catalogue);
}

TEST_F(DiskFullTest, AFlushThatFailsIsRepeated) {
  write_buffer_bytes_ = 64U << 10;
  auto catalogue = Open();
  Prepare(*catalogue);
  disk_->SetSpace(300'000);
  int number = 0;
  while (catalogue->PutView(View(number)).ok()) ++number;
  EXPECT_GT(number, 5);
  EXPECT_TRUE(TakePicture(*catalogue).ok());
  disk_->SetSpace(FaultyDisk::kMuchSpace);
  ASSERT_NO_FATAL_FAILURE(PutMore(*catalogue, number));
  ExpectDurableWhenClosed(std::move(catalogue));
}

// RocksDB 7.8 alone waits for ever in some of these rounds: see Database::Resume().
TEST_F(DiskFullTest, AWriteWhileAFlushFailsIsRepeated) {
  write_buffer_bytes_ = 64U << 10;
  auto catalogue = Open();
  Prepare(*catalogue);
  int number = 0;
  for (int round = 0; round < 3; ++round) {
    disk_->FailSortedFiles(1);
    disk_->SetSpace(100'000);  // a flush begins after seven views, and the log has room for ten
    while (catalogue->PutView(View(number)).ok()) ++number;
    disk_->FailSortedFiles(0);
    disk_->SetSpace(FaultyDisk::kMuchSpace);
    ASSERT_NO_FATAL_FAILURE(PutMore(*catalogue, number));
  }
  ExpectDurableWhenClosed(std::move(catalogue));
}

TEST_F(DiskFullTest, WritesGoOnWhileCompactionsFail) {
  write_buffer_bytes_ = 64U << 10;
  auto catalogue = Open();
  Prepare(*catalogue);
  disk_->FailCompactions(true);
  int number = 0;
  for (; disk_->failed_compactions() == 0; ++number) {
    ASSERT_TRUE(catalogue->PutView(View(number)).ok());
  }
  for (const int last = number + 40; number < last; ++number) {
    ASSERT_TRUE(catalogue->PutView(View(number)).ok());
  }
  ExpectDurableWhenClosed(std::move(catalogue));
}

TEST_F(DiskFullTest, RoomThatIsTakenMeanwhileIsNotCountedOn) {
  const auto catalogue = Open();
  Prepare(*catalogue);
  disk_->SetSpace(3000);
  EXPECT_TRUE(absl::IsResourceExhausted(catalogue->PutView(View(1)).status()));
  disk_->SetSpace(FaultyDisk::kMuchSpace);
  disk_->TakeMeasuredSpace(100);
  EXPECT_TRUE(absl::IsResourceExhausted(catalogue->PutView(View(1)).status()));
  EXPECT_GT(disk_->space(), 0) << "no flush has begun";
  disk_->SetSpace(FaultyDisk::kMuchSpace);
  const absl::Status put = Repeat([&] { return catalogue->PutView(View(1)).status(); });
  ASSERT_TRUE(put.ok()) << put;
  ExpectDurable(*catalogue);
}

TEST_F(DiskFullTest, UploadsAndBackupsGoOnAfterwards) {
  const auto catalogue = Open();
  Prepare(*catalogue);
  Uploads& uploads = catalogue->uploads();
  UploadRecord wanted;
  wanted.set_name("uploads/bulk");
  const auto upload = uploads.Create(wanted, absl::UnixEpoch());
  ASSERT_TRUE(upload.ok());
  ASSERT_TRUE(uploads.Stage(*upload, View(1)).ok());
  disk_->SetSpace(100);
  EXPECT_TRUE(absl::IsResourceExhausted(uploads.Stage(*upload, View(2)).status()));
  EXPECT_TRUE(
      absl::IsResourceExhausted(uploads.Commit(*uploads.Get("uploads/bulk"), false).status()));
  std::filesystem::create_directory(directory_ / "backups");
  Backups backups(directory_ / "backups");
  EXPECT_FALSE(backups.Create(*catalogue).ok()) << "the log may have a rejected write";

  disk_->SetSpace(FaultyDisk::kMuchSpace);
  const absl::Status staged = Repeat([&] { return uploads.Stage(*upload, View(2)).status(); });
  ASSERT_TRUE(staged.ok()) << staged;
  ASSERT_TRUE(uploads.Commit(*uploads.Get("uploads/bulk"), false).ok());
  EXPECT_EQ(catalogue->counts().views, 2);
  const auto made = backups.Create(*catalogue);
  ASSERT_TRUE(made.ok()) << made.status();
  EXPECT_TRUE(backups.Verify(made->id).ok());
  ExpectDurable(*catalogue);
}

TEST_F(DiskFullTest, ABackupWhoseFlushFindsTheDiskFullSucceedsLaterWithoutAWrite) {
  const auto catalogue = Open();
  Prepare(*catalogue);
  std::filesystem::create_directory(directory_ / "backups");
  Backups backups(directory_ / "backups");
  disk_->FailSortedFiles(1);
  const absl::Status full = backups.Create(*catalogue).status();
  EXPECT_TRUE(absl::IsResourceExhausted(full)) << full;
  const absl::Status made = Repeat([&] { return backups.Create(*catalogue).status(); });
  ASSERT_TRUE(made.ok()) << made;
  EXPECT_TRUE(backups.Verify(1).ok());
  ASSERT_TRUE(catalogue->PutView(View(1)).ok());
  ExpectDurable(*catalogue);
}

}  // namespace
}  // namespace graspdb::storage
