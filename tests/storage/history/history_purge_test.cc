// History that is no longer kept.
#include "gmock/gmock.h"
#include "tests/storage/history_fixture.h"

namespace graspdb::storage {
namespace {

class HistoryPurgeTest : public HistoryTest {};

TEST_F(HistoryPurgeTest, APurgeFreesTheCloudsOfADeletedObject) {
  EXPECT_TRUE(absl::IsNotFound(history().Purge(kMug))) << "not deleted";
  const std::int64_t before = catalogue_->revision();
  DeleteMug();
  EXPECT_EQ(StoredClouds().size(), 3U);
  const std::int64_t revision = catalogue_->revision();
  ASSERT_TRUE(history().Purge(kMug).ok());
  EXPECT_EQ(catalogue_->revision(), revision) << "no change of the catalogue";
  EXPECT_THAT(StoredClouds(), ::testing::IsEmpty());
  EXPECT_TRUE(absl::IsNotFound(history().Undelete(kMug).status()));
  EXPECT_TRUE(absl::IsNotFound(history().Restore(kMug, before, "").status()));
  EXPECT_TRUE(absl::IsNotFound(history().List(kMug, 10, 0).status()));
  EXPECT_EQ(RevisionsOf("objects/mugs").size(), 1U) << "others stay";
}

TEST_F(HistoryPurgeTest, OldHistoryIsPurgedWithTheCloudsThatNothingUses) {
  ASSERT_TRUE(catalogue_->DeleteView(MugView(0)).ok());
  now_ += absl::Hours(24);
  Put(0, 7);
  ASSERT_TRUE(catalogue_->DeleteView(MugView(1)).ok());
  const std::int64_t kept = catalogue_->revision() - 1;
  EXPECT_EQ(StoredClouds().size(), 4U);
  const auto purged = history().PurgeOlderThan(kStart + absl::Hours(1));
  ASSERT_TRUE(purged.ok()) << purged.status();
  EXPECT_THAT(*purged, ::testing::IsEmpty()) << "nothing was a deleted object";
  EXPECT_THAT(StoredClouds(),
              ::testing::UnorderedElementsAre(MugView(0) + "@9", MugView(1), MugView(2)));
  EXPECT_EQ(RevisionsOf(kMug).size(), 2U);
  EXPECT_TRUE(absl::IsOutOfRange(history().Restore(kMug, 5, "").status()));
  ASSERT_TRUE(history().Restore(kMug, kept, "").ok());
  EXPECT_EQ(catalogue_->counts().views, 3);
  Take();
  // All of it: the views that are there keep their clouds.
  ASSERT_TRUE(history().PurgeOlderThan(kStart + absl::Hours(48)).ok());
  EXPECT_EQ(StoredClouds().size(), 3U);
  Take();
}

TEST_F(HistoryPurgeTest, ADeletedObjectIsPurgedByTheTimeOfItsDeletion) {
  now_ += absl::Hours(24);
  DeleteMug();
  ASSERT_THAT(*history().PurgeOlderThan(kStart + absl::Hours(1)), ::testing::IsEmpty());
  Open();
  EXPECT_EQ(StoredClouds().size(), 3U);
  ASSERT_TRUE(history().Undelete(kMug).ok());
  Take();
  DeleteMug();
  EXPECT_THAT(*history().PurgeOlderThan(now_ + absl::Seconds(1)), ::testing::ElementsAre(kMug));
  EXPECT_THAT(StoredClouds(), ::testing::IsEmpty());
  EXPECT_TRUE(absl::IsNotFound(history().Undelete(kMug).status()));
}

TEST_F(HistoryPurgeTest, AChangeWhileTheClockWasBehindIsKeptAsLongAsThoseBeforeIt) {
  now_ += absl::Hours(24);
  Rename("Cup");
  const std::int64_t renamed = catalogue_->revision();
  now_ -= absl::Hours(48);
  DeleteMug();
  EXPECT_THAT(*history().PurgeOlderThan(kStart + absl::Hours(1)), ::testing::IsEmpty());
  EXPECT_EQ(RevisionsOf(kMug).back(), renamed) << "only what is older is purged";
  ASSERT_TRUE(history().Undelete(kMug).ok());
  Take();
  EXPECT_THAT(*history().PurgeOlderThan(kStart + absl::Hours(25)), ::testing::IsEmpty());
  EXPECT_THAT(RevisionsOf(kMug), ::testing::IsEmpty());
}

}  // namespace
}  // namespace graspdb::storage
