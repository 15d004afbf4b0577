// Deleted objects and earlier revisions of objects.
#include <functional>
#include <vector>

#include "gmock/gmock.h"
#include "storage/changes/change_author.h"
#include "storage/changes/schema.h"
#include "storage/uploads/uploads.h"
#include "tests/storage/history_fixture.h"
#include "tests/storage/rocksdb_access.h"

namespace graspdb::storage {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST_F(HistoryTest, ADeletedObjectComesBackAsItWas) {
  Pick(3);
  const Picture before = Take();
  now_ += absl::Hours(1);
  DeleteMug();
  EXPECT_TRUE(absl::IsNotFound(catalogue_->GetObject(kMug).status()));
  EXPECT_TRUE(absl::IsNotFound(catalogue_->GetPackedCloud(MugView(0)).status()));
  EXPECT_EQ(catalogue_->counts().views, 0);
  Take();
  const auto deleted = history().ListDeleted(10, "");
  ASSERT_TRUE(deleted.ok()) << deleted.status();
  ASSERT_EQ(deleted->records.size(), 1U);
  EXPECT_EQ(deleted->records[0].object().display_name(), "Mug");
  EXPECT_EQ(deleted->records[0].object().delete_time().seconds(), absl::ToUnixSeconds(now_));
  Open();

  const std::int64_t revision = catalogue_->revision();
  const auto undeleted = history().Undelete(kMug);
  ASSERT_TRUE(undeleted.ok()) << undeleted.status();
  EXPECT_EQ(catalogue_->revision(), revision + 1) << "one change";
  EXPECT_EQ(undeleted->SerializeAsString(), catalogue_->GetObject(kMug)->SerializeAsString());
  EXPECT_FALSE(undeleted->has_delete_time());
  const Picture after = Take();
  EXPECT_EQ(ContentOf(after), ContentOf(before));
  EXPECT_EQ(after.clouds, before.clouds);
  EXPECT_EQ(catalogue_->GetGraspOutcomes(kMugUpright)->counts(0).picked_count(), 3);
  EXPECT_TRUE(history().ListDeleted(10, "")->records.empty());
  const absl::Status again = history().Undelete(kMug).status();
  EXPECT_TRUE(absl::IsNotFound(again));
  EXPECT_THAT(std::string(again.message()),
              HasSubstr("no deleted object objects/mug; graspdb objects list --deleted"));
  EXPECT_TRUE(absl::IsInvalidArgument(history().Undelete("mug").status()));
}

TEST_F(HistoryTest, EveryEarlierRevisionCanBeRestored) {
  std::vector<Picture> pictures(1);  // by revision - first
  const std::int64_t first = catalogue_->revision();
  const auto remember = [&] { pictures.push_back(Take()); };
  pictures[0] = Take();
  const std::vector<std::function<void()>> changes = {
      [&] { Rename("Cup"); },
      [&] { ASSERT_TRUE(catalogue_->DeleteView(MugView(1)).ok()); },
      [&] { Put(1, 7); },  // other content under the same name
      [&] { OpenGripper(0.09); },
      [&] { ASSERT_TRUE(catalogue_->CreateStablePose(MakeStablePose("mug", "lying")).ok()); },
      [&] { ASSERT_TRUE(catalogue_->DeleteStablePose(kMugUpright, true, "").ok()); },
      [&] { ASSERT_TRUE(catalogue_->CreateStablePose(MakeStablePose("mug", "upright")).ok()); },
      [&] { Put(0, 9); },
      [&] { DeleteMug(); },
      [&] { ASSERT_TRUE(catalogue_->CreateObject(MakeObject("mug", "Another")).ok()); },
  };
  for (const auto& change : changes) {
    change();
    remember();
  }
  ASSERT_EQ(catalogue_->revision(), first + std::ssize(changes)) << "one change each";
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    // Back and forth.
    const std::size_t at = i % 2 == 0 ? i : pictures.size() - 1 - i;
    const auto restored = history().Restore(kMug, first + static_cast<std::int64_t>(at), "");
    if (!pictures[at].records.contains(kMug)) {
      EXPECT_TRUE(absl::IsNotFound(restored.status())) << restored.status();
      continue;
    }
    ASSERT_TRUE(restored.ok()) << at << ": " << restored.status();
    const Picture now = Take();
    EXPECT_EQ(ContentOf(now), ContentOf(pictures[at])) << at;
    EXPECT_EQ(now.clouds, pictures[at].clouds) << at;
  }
}

TEST_F(HistoryTest, ARestoreWithoutADifferenceIsNoChange) {
  const std::int64_t revision = catalogue_->revision();
  EXPECT_EQ(history().Restore(kMug, revision, "")->display_name(), "Mug");
  EXPECT_EQ(history().Restore(kMug, 5, "")->display_name(), "Mug");
  EXPECT_EQ(catalogue_->revision(), revision);
}

TEST_F(HistoryTest, RestoreChecksItsArguments) {
  const std::int64_t revision = catalogue_->revision();
  const absl::Status late = history().Restore(kMug, revision + 1, "").status();
  EXPECT_TRUE(absl::IsOutOfRange(late));
  EXPECT_THAT(std::string(late.message()), HasSubstr("revisions 1 to"));
  EXPECT_TRUE(absl::IsOutOfRange(history().Restore(kMug, -1, "").status()));
  EXPECT_TRUE(absl::IsNotFound(history().Restore("objects/mugs", 3, "").status()));
  EXPECT_TRUE(absl::IsNotFound(history().Restore("objects/none", 3, "").status()));
  EXPECT_TRUE(absl::IsInvalidArgument(history().Restore("cells/a", 3, "").status()));
  EXPECT_TRUE(absl::IsAborted(history().Restore(kMug, 1, "r99").status()));
  EXPECT_EQ(catalogue_->revision(), revision);
  EXPECT_TRUE(history().Restore(kMug, 1, catalogue_->GetObject(kMug)->etag()).ok());
}

TEST_F(HistoryTest, OutcomesOfGraspsThatChangedSinceAreNotRestored) {
  Pick(5);
  const std::int64_t revision = catalogue_->revision();
  OpenGripper(0.08);
  Pick(1);
  ASSERT_TRUE(history().Restore(kMug, revision, "").ok());
  EXPECT_EQ(catalogue_->GetStablePose(kMugUpright)->grasps(0).gripper_opening_m(), 0.06);
  EXPECT_THAT(catalogue_->GetGraspOutcomes(kMugUpright)->counts(), IsEmpty());
}

TEST_F(HistoryTest, ListsWhatChangedWhenAndByWhom) {
  now_ += absl::Minutes(5);
  {
    const ChangeAuthor author({"anna", "UpdateObject"});
    Rename("Cup");
  }
  DeleteMug();
  const auto page = history().List(kMug, 2, 0);
  ASSERT_TRUE(page.ok()) << page.status();
  ASSERT_EQ(page->records.size(), 2U);
  EXPECT_TRUE(page->more);
  const HistoryRecord& deletion = page->records[0];
  EXPECT_EQ(deletion.identity(), "");
  EXPECT_EQ(deletion.edit_count(), 5) << "the object, a stable pose and three views";
  EXPECT_TRUE(deletion.previous(0).removed());
  const HistoryRecord& renaming = page->records[1];
  EXPECT_EQ(renaming.identity(), "anna");
  EXPECT_EQ(renaming.method(), "UpdateObject");
  EXPECT_EQ(renaming.time().seconds(), absl::ToUnixSeconds(now_));
  ASSERT_EQ(renaming.previous_size(), 1);
  EXPECT_EQ(renaming.previous(0).key(), kMug);
  EXPECT_THAT(renaming.previous(0).fields(), ElementsAre("display_name"));
  const auto rest = history().List(kMug, 100, renaming.revision());
  ASSERT_TRUE(rest.ok());
  EXPECT_FALSE(rest->more);
  ASSERT_EQ(rest->records.size(), 5U);
  EXPECT_FALSE(rest->records.back().previous(0).has_value()) << "created";
  EXPECT_TRUE(absl::IsNotFound(history().List("objects/none", 100, 0).status()));
}

TEST_F(HistoryTest, ALargeChangeIsListedAsOneAndRestoredAsAWhole) {
  std::vector<NewView> views;
  for (int i = 100; i < 1300; ++i) views.push_back(MakeView(MugView(i), i, 10));
  ASSERT_TRUE(catalogue_->PutViews(views).ok());
  const Picture before = Take();
  DeleteMug();
  const auto page = history().List(kMug, 1, 0);
  ASSERT_EQ(page->records.size(), 1U);
  EXPECT_EQ(page->records[0].edit_count(), 1205);
  EXPECT_LT(page->records[0].ByteSizeLong(), 100'000U);
  ASSERT_TRUE(history().Undelete(kMug).ok());
  EXPECT_EQ(ContentOf(Take()), ContentOf(before));
}

TEST_F(HistoryTest, DescriptorsOutcomesAndCellsAreNotInIt) {
  const auto before = RevisionsOf(kMug);
  Pick(1);
  const std::string digest = catalogue_->GetView(MugView(0))->content_digest();
  const std::int64_t revision = catalogue_->revision();
  EXPECT_GT(
      *catalogue_->ReplaceDescriptors(std::vector<DescriptorUpdate>{{MugView(0), digest, {}}}),
      revision);
  ASSERT_TRUE(catalogue_->CreateCell(MakeCell("mug")).ok());
  EXPECT_EQ(RevisionsOf(kMug), before);
}

TEST_F(HistoryTest, AViewThatAnUploadReplacedComesBack) {
  const Picture before = Take();
  UploadRecord wanted;
  wanted.set_name("uploads/monday");
  wanted.set_replace(true);
  const auto upload = catalogue_->uploads().Create(wanted, now_);
  ASSERT_TRUE(upload.ok()) << upload.status();
  ASSERT_TRUE(catalogue_->uploads().Stage(*upload, MakeView(MugView(0), 5, 700)).ok());
  ASSERT_TRUE(catalogue_->uploads().Stage(*upload, MakeView(MugView(8), 6, 700)).ok());
  ASSERT_TRUE(
      catalogue_->uploads().Commit(*catalogue_->uploads().Get("uploads/monday"), false).ok());
  EXPECT_NE(Take().clouds, before.clouds);
  ASSERT_TRUE(history().Restore(kMug, before.revision, "").ok());
  EXPECT_EQ(ContentOf(Take()), ContentOf(before));
  EXPECT_EQ(Take().clouds, before.clouds);
}

TEST_F(HistoryTest, AnUploadIntoADeletedObjectDropsItsViews) {
  UploadRecord wanted;
  wanted.set_name("uploads/monday");
  const auto upload = catalogue_->uploads().Create(wanted, now_);
  ASSERT_TRUE(upload.ok()) << upload.status();
  ASSERT_TRUE(catalogue_->uploads().Stage(*upload, MakeView(MugView(8), 6, 700)).ok());
  DeleteMug();
  EXPECT_TRUE(absl::IsFailedPrecondition(
      catalogue_->uploads().Commit(*catalogue_->uploads().Get("uploads/monday"), false).status()));
  EXPECT_EQ(catalogue_->uploads()
                .Commit(*catalogue_->uploads().Get("uploads/monday"), true)
                ->failed_count(),
            1);
  ASSERT_TRUE(history().Undelete(kMug).ok());
  EXPECT_EQ(catalogue_->counts().views, 3);
}

TEST_F(HistoryTest, AMigratedDatabaseHasAHistoryFromThenOn) {
  const std::int64_t revision = catalogue_->revision();
  catalogue_.reset();
  DropFamily(directory_ / "db", "history");
  DropFamily(directory_ / "db", "deleted_objects");
  SetSchemaVersion(directory_ / "db", 3);
  Open();
  EXPECT_EQ(catalogue_->schema_version(), kSchemaVersion);
  EXPECT_THAT(RevisionsOf(kMug), IsEmpty());
  EXPECT_TRUE(absl::IsOutOfRange(history().Restore(kMug, revision - 1, "").status()));
  Rename("Cup");
  EXPECT_EQ(history().Restore(kMug, revision, "")->display_name(), "Mug");
}

TEST_F(HistoryTest, ATornLogLosesWholeStepsOnly) {
  DeleteMug();
  CopyDatabase(directory_ / "db", directory_ / "copy");
  const auto copy = OpenOrDie(directory_ / "copy");
  EXPECT_TRUE(copy->history().Undelete(kMug).ok());
  EXPECT_EQ(copy->GetPackedCloud(MugView(2)).ok(), true);
}

}  // namespace
}  // namespace graspdb::storage
