// The number of change records that are kept, and errors for readers that need older ones.
#include <algorithm>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "storage/catalogue/catalogue.h"
#include "storage/database/family.h"
#include "storage/records/resource_name.h"
#include "tests/storage/catalogue_fixture.h"
#include "tests/storage/rocksdb_access.h"

namespace graspdb::storage {
namespace {

using ::testing::ElementsAre;

class KeptChangesTest : public ::testing::Test {
 protected:
  void Open(std::int64_t keep) {
    catalogue_.reset();
    CatalogueOptions options;
    options.keep_changes = keep;
    catalogue_ = OpenOrDie(directory_ / "db", options);
  }

  // Revisions of the changes after `revision`.
  std::vector<std::int64_t> ChangesAfter(std::int64_t revision) {
    const auto changes = catalogue_->ReadChanges(revision, 1'000'000);
    EXPECT_TRUE(changes.ok()) << changes.status();
    std::vector<std::int64_t> revisions;
    if (!changes.ok()) return revisions;
    for (const ChangeRecord& change : *changes) revisions.push_back(change.revision());
    return revisions;
  }

  // The newest revision whose change record is deleted.
  std::int64_t Horizon() {
    std::int64_t horizon = 0;
    while (absl::IsOutOfRange(catalogue_->ReadChanges(horizon, 1).status())) ++horizon;
    return horizon;
  }

  TemporaryDirectory directory_;
  std::unique_ptr<Catalogue> catalogue_;
};

TEST_F(KeptChangesTest, OnlyTheNewestChangesAreKept) {
  Open(5);
  MakeHistory(*catalogue_, [] {});
  for (int restart = 0; restart < 2; ++restart) {
    EXPECT_THAT(ChangesAfter(7), ElementsAre(8, 9, 10, 11, 12));
    EXPECT_THAT(ChangesAfter(10), ElementsAre(11, 12));
    for (const std::int64_t gone : {0, 6}) {
      const auto changes = catalogue_->ReadChanges(gone, 5);
      EXPECT_TRUE(absl::IsOutOfRange(changes.status())) << changes.status();
      EXPECT_THAT(std::string(changes.status().message()),
                  ::testing::HasSubstr("read all records"));
    }
    Open(5);
  }
}

TEST_F(KeptChangesTest, OthersSurviveACrashAtAnyTime) {
  Open(3);
  MakeHistory(*catalogue_, [&] {
    CopyDatabase(directory_ / "db", directory_ / "copy");
    const auto copy = OpenOrDie(directory_ / "copy");
    const std::int64_t revision = catalogue_->revision();
    EXPECT_EQ(copy->revision(), revision);
    const std::int64_t horizon = std::max<std::int64_t>(0, revision - 3);
    const auto changes = copy->ReadChanges(horizon, 100);
    ASSERT_TRUE(changes.ok()) << changes.status();
    EXPECT_EQ(static_cast<std::int64_t>(changes->size()), revision - horizon);
  });
}

TEST_F(KeptChangesTest, BacklogIsDeletedWithTheNextChanges) {
  Open(1'000'000);
  MakeHistory(*catalogue_, [] {});
  std::vector<NewView> views;
  views.reserve(1500);
  for (int i = 0; i < 1500; ++i) {
    views.push_back(MakeView(MakeViewName("mug", "upright", "more-" + std::to_string(i)), i,
                             /*cloud_bytes=*/1));
  }
  ASSERT_TRUE(catalogue_->PutViews(views).ok());
  EXPECT_EQ(Horizon(), 0);
  Open(10);
  std::int64_t before = 0;
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(catalogue_->CreateObject(MakeObject("o" + std::to_string(i))).ok());
    EXPECT_GT(Horizon(), before);
    before = Horizon();
  }
  EXPECT_EQ(Horizon(), catalogue_->revision() - 10);
}

TEST_F(KeptChangesTest, OneWriteMayMakeMoreChangesThanAreKept) {
  Open(2);
  MakeHistory(*catalogue_, [] {});
  std::vector<NewView> views;
  views.reserve(7);
  for (int i = 0; i < 7; ++i) {
    views.push_back(MakeView(MakeViewName("mug", "upright", "more-" + std::to_string(i)), i));
  }
  ASSERT_TRUE(catalogue_->PutViews(views).ok());
  EXPECT_THAT(ChangesAfter(17), ElementsAre(18, 19));
  Open(2);
  EXPECT_THAT(ChangesAfter(17), ElementsAre(18, 19));
}

TEST_F(KeptChangesTest, PickCountsDoNotDependOnKeptChanges) {
  Open(3);
  ASSERT_TRUE(catalogue_->CreateObject(MakeObject("mug")).ok());
  ASSERT_TRUE(catalogue_->CreateStablePose(MakeStablePose("mug", "upright")).ok());
  v1::GraspOutcomeCounts pick;
  pick.set_grasp_id("top");
  pick.set_picked_count(1);
  for (int i = 0; i < 50; ++i) {
    ASSERT_TRUE(catalogue_->AddGraspOutcomes("objects/mug/stablePoses/upright", pick).ok());
  }
  Open(3);
  const auto outcomes = catalogue_->GetGraspOutcomes("objects/mug/stablePoses/upright");
  ASSERT_TRUE(outcomes.ok());
  EXPECT_EQ(outcomes->counts(0).picked_count(), 50);
  EXPECT_EQ(catalogue_->revision(), 52);
  EXPECT_EQ(Horizon(), 49);
}

TEST_F(KeptChangesTest, MissingKeptChangeIsDamage) {
  Open(5);
  MakeHistory(*catalogue_, [] {});
  catalogue_.reset();
  Tamper(directory_ / "db", "changes", ChangeKey(8), nullptr);
  EXPECT_TRUE(absl::IsDataLoss(Catalogue::Open(directory_ / "db").status()));
}

}  // namespace
}  // namespace graspdb::storage
