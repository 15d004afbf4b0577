// A disk that loses unsynced bytes, or fails.
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "storage/catalogue/catalogue.h"
#include "tests/storage/catalogue_fixture.h"
#include "tests/storage/faulty_disk.h"

namespace graspdb::storage {
namespace {

using ::testing::HasSubstr;

class PowerLossTest : public ::testing::Test {
 protected:
  std::unique_ptr<Catalogue> Open() {
    CatalogueOptions options;
    options.env = env_.get();
    options.write_buffer_bytes = 64U << 10;
    return OpenOrDie(database_, options);
  }

  TemporaryDirectory directory_;
  const std::string database_ = directory_ / "db";
  const std::string copy_ = directory_ / "copy";
  const std::shared_ptr<FaultyDisk> disk_ = std::make_shared<FaultyDisk>();
  const std::unique_ptr<rocksdb::Env> env_ = rocksdb::NewCompositeEnv(disk_);
};

TEST_F(PowerLossTest, AcknowledgedChangesSurviveTheLossOfUnsyncedBytes) {
  const auto catalogue = Open();
  MakeHistory(*catalogue, [&] {
    disk_->CopyOpen(database_, copy_, FaultyDisk::Unsynced::kLost);
    const auto recovered = TakePicture(*OpenOrDie(copy_));
    ASSERT_TRUE(recovered.ok()) << recovered.status();
    EXPECT_EQ(*recovered, *TakePicture(*catalogue));
  });
}

TEST_F(PowerLossTest, AcknowledgedChangesSurviveDuringFlushes) {
  std::mt19937 random(5);
  int view = 0;
  for (int round = 0; round < 8; ++round) {
    const auto disk = std::make_shared<FaultyDisk>();
    const std::unique_ptr<rocksdb::Env> env = rocksdb::NewCompositeEnv(disk);
    CatalogueOptions options;
    options.env = env.get();
    options.write_buffer_bytes = 64U << 10;  // a flush every seven views or so
    auto catalogue = OpenOrDie(database_, options);
    if (round == 0) {
      ASSERT_TRUE(catalogue->CreateObject(MakeObject("mug")).ok());
      ASSERT_TRUE(catalogue->CreateStablePose(MakeStablePose("mug", "upright")).ok());
    }
    for (unsigned i = 0; i < 8 + random() % 30; ++i, ++view) {
      const std::string name = "objects/mug/stablePoses/upright/views/" + std::to_string(view);
      ASSERT_TRUE(catalogue->PutView(MakeView(name, view, 9000)).ok());
    }
    disk->Stop();
    catalogue.reset();
    disk->LosePower(database_);
    const auto recovered = OpenOrDie(database_);
    ASSERT_EQ(recovered->revision(), view + 2);
    const auto picture = TakePicture(*recovered);
    ASSERT_TRUE(picture.ok()) << picture.status();
  }
}

TEST_F(PowerLossTest, EveryMutationSyncsTheLogOnceAndReadsDoNot) {
  const auto catalogue = Open();
  ASSERT_TRUE(catalogue->CreateObject(MakeObject("mug")).ok());
  ASSERT_TRUE(catalogue->CreateStablePose(MakeStablePose("mug", "upright")).ok());
  int before = disk_->syncs_of_logs();
  ASSERT_TRUE(catalogue->CreateObject(MakeObject("bowl")).ok());
  EXPECT_EQ(disk_->syncs_of_logs(), before + 1);
  ASSERT_FALSE(catalogue->CreateObject(MakeObject("bowl")).ok());
  ASSERT_TRUE(TakePicture(*catalogue).ok());
  EXPECT_EQ(disk_->syncs_of_logs(), before + 1);
  const std::string views = "objects/mug/stablePoses/upright/views/";
  const std::vector<NewView> bulk = {MakeView(views + "0", 1), MakeView(views + "1", 2),
                                     MakeView(views + "2", 3)};
  ASSERT_TRUE(catalogue->PutViews(bulk).ok());
  EXPECT_EQ(disk_->syncs_of_logs(), before + 2) << "one for the whole bulk";
}

TEST_F(PowerLossTest, ChangesAreRejectedAfterAFailedWriteUntilTheDiskWorks) {
  auto catalogue = Open();
  std::vector<std::int64_t> notified;
  ASSERT_TRUE(catalogue->CreateObject(MakeObject("before")).ok());
  ASSERT_TRUE(
      catalogue
          ->Subscribe([&](const ChangeRecord& change) { notified.push_back(change.revision()); })
          .ok());
  disk_->FailSyncsOfLogs(true);
  const absl::Status failed = catalogue->CreateObject(MakeObject("lost")).status();
  EXPECT_TRUE(absl::IsUnavailable(failed)) << failed;
  EXPECT_THAT(std::string(failed.message()), HasSubstr("the disk is on fire"));
  EXPECT_EQ(catalogue->revision(), 1);
  EXPECT_TRUE(notified.empty()) << "changes that are not durable are not reported";

  const WriteFault fault = catalogue->database_status().write_fault;
  EXPECT_TRUE(absl::IsUnavailable(fault.error)) << fault.error;
  EXPECT_TRUE(catalogue->GetObject("objects/before").ok()) << "reading continues";

  disk_->FailSyncsOfLogs(false);
  absl::Status after = catalogue->CreateObject(MakeObject("after")).status();
  while (absl::IsUnavailable(after)) after = catalogue->CreateObject(MakeObject("after")).status();
  EXPECT_TRUE(after.ok()) << after;
  EXPECT_EQ(catalogue->revision(), 2);
  EXPECT_EQ(notified, std::vector<std::int64_t>{2});
  EXPECT_TRUE(catalogue->database_status().write_fault.error.ok());
  catalogue.reset();
  disk_->LosePower(database_);
  catalogue = Open();
  EXPECT_TRUE(TakePicture(*catalogue).ok());
  EXPECT_TRUE(catalogue->GetObject("objects/before").ok());
  EXPECT_TRUE(catalogue->GetObject("objects/after").ok());
  EXPECT_TRUE(absl::IsNotFound(catalogue->GetObject("objects/lost").status()));
}

}  // namespace
}  // namespace graspdb::storage
