// Objects, stable poses and cells: create, read, list, update, delete.
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "storage/catalogue/catalogue.h"
#include "storage/records/resource_name.h"
#include "tests/storage/catalogue_fixture.h"
#include "tests/storage/rocksdb_access.h"

namespace graspdb::storage {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class CatalogueResourcesTest : public ::testing::Test {
 protected:
  CatalogueOptions Options() {
    CatalogueOptions options;
    options.clock = [this] { return now_; };
    return options;
  }

  TemporaryDirectory directory_;
  absl::Time now_ = absl::FromUnixMillis(1'700'000'000'250);
  std::unique_ptr<Catalogue> catalogue_ = OpenOrDie(directory_ / "db", Options());
};

template <typename Record>
std::vector<std::string> Names(const absl::StatusOr<Page<Record>>& page) {
  EXPECT_TRUE(page.ok()) << page.status();
  std::vector<std::string> names;
  if (!page.ok()) return names;
  for (const Record& record : page->records) names.push_back(record.name());
  return names;
}

absl::Status Rename(v1::Object& object) {
  object.set_display_name("renamed");
  return absl::OkStatus();
}

TEST_F(CatalogueResourcesTest, CreatedObjectHasItsTimes) {
  v1::Object wanted = MakeObject("mug", "Mug");
  wanted.set_etag("chosen by the caller");
  const auto created = catalogue_->CreateObject(wanted);
  ASSERT_TRUE(created.ok()) << created.status();
  EXPECT_EQ(created->display_name(), "Mug");
  EXPECT_EQ(created->create_time().seconds(), 1'700'000'000);
  EXPECT_EQ(created->create_time().nanos(), 250'000'000);
  EXPECT_EQ(created->update_time().seconds(), 1'700'000'000);
  EXPECT_NE(created->etag(), "chosen by the caller");

  const auto read = catalogue_->GetObject("objects/mug");
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->SerializeAsString(), created->SerializeAsString());
  EXPECT_EQ(catalogue_->counts().objects, 1);
}

TEST_F(CatalogueResourcesTest, AClockThatIsSetChangesTimesOnly) {
  const auto created = catalogue_->CreateObject(MakeObject("mug"));
  ASSERT_TRUE(created.ok()) << created.status();
  std::string etag = created->etag();
  for (const absl::Duration jump : {absl::Hours(-9000), absl::Hours(90'000), absl::Hours(-1)}) {
    now_ += jump;
    const auto updated = catalogue_->UpdateObject("objects/mug", etag, Rename);
    ASSERT_TRUE(updated.ok()) << updated.status();
    EXPECT_NE(updated->etag(), etag);
    EXPECT_EQ(updated->create_time().seconds(), created->create_time().seconds());
    EXPECT_EQ(updated->update_time().seconds(), absl::ToUnixSeconds(now_));
    etag = updated->etag();
  }
  const auto changes = catalogue_->ReadChanges(0, 10);
  ASSERT_TRUE(changes.ok()) << changes.status();
  ASSERT_EQ(changes->size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ((*changes)[i].revision(), static_cast<std::int64_t>(i) + 1);
  }
}

TEST_F(CatalogueResourcesTest, NamesAreUnique) {
  ASSERT_TRUE(catalogue_->CreateObject(MakeObject("mug", "first")).ok());
  const auto again = catalogue_->CreateObject(MakeObject("mug", "second"));
  EXPECT_EQ(again.status().code(), absl::StatusCode::kAlreadyExists);
  EXPECT_THAT(std::string(again.status().message()), HasSubstr("objects/mug"));
  EXPECT_EQ(catalogue_->GetObject("objects/mug")->display_name(), "first");
  EXPECT_EQ(catalogue_->revision(), 1);
}

TEST_F(CatalogueResourcesTest, InvalidAndUnknownNamesHaveDifferentErrors) {
  v1::Object nameless;
  EXPECT_TRUE(absl::IsInvalidArgument(catalogue_->CreateObject(nameless).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(catalogue_->GetObject("cells/a").status()));
  EXPECT_TRUE(absl::IsNotFound(catalogue_->GetObject("objects/a").status()));
  EXPECT_TRUE(absl::IsNotFound(catalogue_->UpdateObject("objects/a", "", Rename).status()));
  EXPECT_TRUE(absl::IsNotFound(catalogue_->DeleteObject("objects/a", true, "")));
  EXPECT_TRUE(absl::IsNotFound(catalogue_->DeleteCell("cells/a", "")));
  EXPECT_TRUE(absl::IsInvalidArgument(catalogue_->DeleteStablePose("objects/a", true, "")));
  EXPECT_EQ(catalogue_->revision(), 0);
}

TEST_F(CatalogueResourcesTest, AStablePoseNeedsItsObject) {
  const auto orphan = catalogue_->CreateStablePose(MakeStablePose("mug", "upright"));
  EXPECT_EQ(orphan.status().code(), absl::StatusCode::kNotFound);
  EXPECT_THAT(std::string(orphan.status().message()), HasSubstr("object objects/mug"));
  ASSERT_TRUE(catalogue_->CreateObject(MakeObject("mug")).ok());
  ASSERT_TRUE(catalogue_->CreateStablePose(MakeStablePose("mug", "upright")).ok());
  const auto read = catalogue_->GetStablePose("objects/mug/stablePoses/upright");
  ASSERT_TRUE(read.ok());
  ASSERT_EQ(read->grasps_size(), 1);
  EXPECT_EQ(read->grasps(0).grasp_id(), "top");
}

TEST_F(CatalogueResourcesTest, AnUpdateKeepsNameAndCreateTimeAndChangesTheEtag) {
  const auto created = catalogue_->CreateObject(MakeObject("mug", "Mug"));
  now_ += absl::Seconds(5);
  const auto updated =
      catalogue_->UpdateObject("objects/mug", created->etag(), [](v1::Object& object) {
        object.set_name("objects/other");
        object.clear_create_time();
        object.set_etag("mine");
        object.set_display_name("Big mug");
        return absl::OkStatus();
      });
  ASSERT_TRUE(updated.ok()) << updated.status();
  EXPECT_EQ(updated->name(), "objects/mug");
  EXPECT_EQ(updated->display_name(), "Big mug");
  EXPECT_EQ(updated->create_time().seconds(), 1'700'000'000);
  EXPECT_EQ(updated->update_time().seconds(), 1'700'000'005);
  EXPECT_NE(updated->etag(), created->etag());
  EXPECT_NE(updated->etag(), "mine");
  EXPECT_EQ(catalogue_->GetObject("objects/mug")->SerializeAsString(),
            updated->SerializeAsString());
}

TEST_F(CatalogueResourcesTest, OldEtagAborts) {
  const auto created = catalogue_->CreateObject(MakeObject("mug", "Mug"));
  const auto updated = catalogue_->UpdateObject("objects/mug", created->etag(), Rename);
  ASSERT_TRUE(updated.ok());
  EXPECT_TRUE(
      absl::IsAborted(catalogue_->UpdateObject("objects/mug", created->etag(), Rename).status()));
  EXPECT_TRUE(absl::IsAborted(catalogue_->DeleteObject("objects/mug", true, created->etag())));
  EXPECT_EQ(catalogue_->revision(), 2);
  EXPECT_TRUE(catalogue_->DeleteObject("objects/mug", true, updated->etag()).ok());
}

TEST_F(CatalogueResourcesTest, RecreatedObjectHasAnotherEtag) {
  const auto first = catalogue_->CreateObject(MakeObject("mug"));
  ASSERT_TRUE(catalogue_->DeleteObject("objects/mug", false, "").ok());
  const auto second = catalogue_->CreateObject(MakeObject("mug"));
  EXPECT_NE(first->etag(), second->etag());
}

TEST_F(CatalogueResourcesTest, AnUpdateThatFailsChangesNothing) {
  const auto created = catalogue_->CreateObject(MakeObject("mug", "Mug"));
  const auto refused = catalogue_->UpdateObject("objects/mug", "", [](v1::Object& object) {
    object.set_display_name("half done");
    return absl::InvalidArgumentError("no such field");
  });
  EXPECT_EQ(refused.status(), absl::InvalidArgumentError("no such field"));
  EXPECT_EQ(catalogue_->GetObject("objects/mug")->SerializeAsString(),
            created->SerializeAsString());
  EXPECT_EQ(catalogue_->revision(), 1);
}

TEST_F(CatalogueResourcesTest, PagesFollowOneAnotherWithoutGapsAndRepeats) {
  for (const char* id : {"c", "a", "e", "b", "d"}) {
    ASSERT_TRUE(catalogue_->CreateObject(MakeObject(id)).ok());
  }
  auto page = catalogue_->ListObjects(2, "");
  EXPECT_THAT(Names(page), ElementsAre("objects/a", "objects/b"));
  EXPECT_TRUE(page->more);
  page = catalogue_->ListObjects(2, "objects/b");
  EXPECT_THAT(Names(page), ElementsAre("objects/c", "objects/d"));
  EXPECT_TRUE(page->more);
  page = catalogue_->ListObjects(2, "objects/d");
  EXPECT_THAT(Names(page), ElementsAre("objects/e"));
  EXPECT_FALSE(page->more);
  page = catalogue_->ListObjects(5, "");
  EXPECT_EQ(page->records.size(), 5U);
  EXPECT_FALSE(page->more);
  EXPECT_THAT(Names(catalogue_->ListObjects(5, "objects/e")), IsEmpty());
}

TEST_F(CatalogueResourcesTest, PageContinuesAfterADeletedName) {
  for (const char* id : {"a", "b", "c"}) {
    ASSERT_TRUE(catalogue_->CreateObject(MakeObject(id)).ok());
  }
  ASSERT_TRUE(catalogue_->DeleteObject("objects/b", false, "").ok());
  EXPECT_THAT(Names(catalogue_->ListObjects(5, "objects/b")), ElementsAre("objects/c"));
}

TEST_F(CatalogueResourcesTest, ListsRejectInvalidArguments) {
  EXPECT_TRUE(absl::IsInvalidArgument(catalogue_->ListObjects(0, "").status()));
  EXPECT_TRUE(absl::IsInvalidArgument(catalogue_->ListObjects(5, "cells/a").status()));
  EXPECT_TRUE(absl::IsNotFound(catalogue_->ListStablePoses("objects/none", 5, "").status()));
  EXPECT_TRUE(absl::IsInvalidArgument(catalogue_->ListStablePoses("objects/", 5, "").status()));
  EXPECT_THAT(Names(catalogue_->ListCells(5, "")), IsEmpty());
}

TEST_F(CatalogueResourcesTest, ChildrenOfASimilarNameAreNotIncluded) {
  // Each of these is a prefix of, or sorts beside, another one.
  for (const char* id : {"a", "ab", "a-", "a.b", "a0", "A"}) {
    ASSERT_TRUE(catalogue_->CreateObject(MakeObject(id)).ok());
    ASSERT_TRUE(catalogue_->CreateStablePose(MakeStablePose(id, "x")).ok());
    ASSERT_TRUE(catalogue_->CreateStablePose(MakeStablePose(id, "x1")).ok());
    const std::string poses = std::string("objects/") + id + "/stablePoses/";
    ASSERT_TRUE(catalogue_->PutView(MakeView(poses + "x/views/0", 1)).ok());
    ASSERT_TRUE(catalogue_->PutView(MakeView(poses + "x1/views/1", 2)).ok());
  }
  EXPECT_THAT(Names(catalogue_->ListStablePoses("objects/a", 9, "")),
              ElementsAre("objects/a/stablePoses/x", "objects/a/stablePoses/x1"));
  EXPECT_THAT(Names(catalogue_->ListViews("objects/a/stablePoses/x", 9, "")),
              ElementsAre("objects/a/stablePoses/x/views/0"));

  ASSERT_TRUE(catalogue_->DeleteStablePose("objects/a/stablePoses/x", true, "").ok());
  EXPECT_THAT(Names(catalogue_->ListViews("objects/a/stablePoses/x1", 9, "")),
              ElementsAre("objects/a/stablePoses/x1/views/1"));
  ASSERT_TRUE(catalogue_->DeleteObject("objects/a", true, "").ok());
  EXPECT_EQ(catalogue_->counts().objects, 5);
  EXPECT_EQ(catalogue_->counts().stable_poses, 10);
  EXPECT_EQ(catalogue_->counts().views, 10);
  EXPECT_TRUE(TakePicture(*catalogue_).ok());
}

TEST_F(CatalogueResourcesTest, ParentsAreDeletedWithForceOnly) {
  const std::string pose = "objects/mug/stablePoses/upright";
  ASSERT_TRUE(catalogue_->CreateObject(MakeObject("mug")).ok());
  ASSERT_TRUE(catalogue_->CreateStablePose(MakeStablePose("mug", "upright")).ok());
  ASSERT_TRUE(catalogue_->PutView(MakeView(pose + "/views/0")).ok());
  EXPECT_TRUE(absl::IsFailedPrecondition(catalogue_->DeleteObject("objects/mug", false, "")));
  EXPECT_TRUE(absl::IsFailedPrecondition(catalogue_->DeleteStablePose(pose, false, "")));
  EXPECT_EQ(catalogue_->revision(), 3);

  ASSERT_TRUE(catalogue_->DeleteObject("objects/mug", true, "").ok());
  EXPECT_EQ(catalogue_->revision(), 4) << "one change in total";
  EXPECT_TRUE(absl::IsNotFound(catalogue_->GetStablePose(pose).status()));
  EXPECT_TRUE(absl::IsNotFound(catalogue_->GetView(pose + "/views/0").status()));
  EXPECT_TRUE(absl::IsNotFound(catalogue_->GetPackedCloud(pose + "/views/0").status()));
  const CatalogueCounts counts = catalogue_->counts();
  EXPECT_EQ(counts.objects + counts.stable_poses + counts.views, 0);
}

TEST_F(CatalogueResourcesTest, RecordsWithoutChildrenAreDeletedWithoutForce) {
  ASSERT_TRUE(catalogue_->CreateObject(MakeObject("mug")).ok());
  ASSERT_TRUE(catalogue_->CreateStablePose(MakeStablePose("mug", "upright")).ok());
  EXPECT_TRUE(catalogue_->DeleteStablePose("objects/mug/stablePoses/upright", false, "").ok());
  EXPECT_TRUE(catalogue_->DeleteObject("objects/mug", false, "").ok());
}

TEST_F(CatalogueResourcesTest, CellsAreIndependentOfObjects) {
  ASSERT_TRUE(catalogue_->CreateObject(MakeObject("line-1")).ok());
  const auto created = catalogue_->CreateCell(MakeCell("line-1"));
  ASSERT_TRUE(created.ok()) << created.status();
  const auto updated = catalogue_->UpdateCell("cells/line-1", created->etag(), [](v1::Cell& cell) {
    cell.mutable_sensor_pose()->mutable_position()->set_z(0.9);
    return absl::OkStatus();
  });
  ASSERT_TRUE(updated.ok());
  EXPECT_EQ(catalogue_->GetCell("cells/line-1")->sensor_pose().position().z(), 0.9);
  EXPECT_THAT(Names(catalogue_->ListCells(9, "")), ElementsAre("cells/line-1"));
  EXPECT_TRUE(absl::IsAborted(catalogue_->DeleteCell("cells/line-1", created->etag())));
  EXPECT_TRUE(catalogue_->DeleteCell("cells/line-1", updated->etag()).ok());
  EXPECT_EQ(catalogue_->counts().cells, 0);
  EXPECT_EQ(catalogue_->counts().objects, 1);
}

TEST_F(CatalogueResourcesTest, ForcedDeletesReadNoCloud) {
  // Large enough for a blob file, and in total to be flushed at the end.
  constexpr std::size_t kCloudBytes = 50'000;
  for (const char* id : {"mug", "bowl"}) {
    ASSERT_TRUE(catalogue_->CreateObject(MakeObject(id)).ok());
    ASSERT_TRUE(catalogue_->CreateStablePose(MakeStablePose(id, "upright")).ok());
    for (int i = 0; i < 20; ++i) {
      const std::string name = MakeViewName(id, "upright", std::to_string(i));
      ASSERT_TRUE(catalogue_->PutView(MakeView(name, i, kCloudBytes)).ok());
    }
  }
  catalogue_.reset();
  catalogue_ = OpenOrDie(directory_ / "db");
  const std::uint64_t before = BlobsReadHere();
  ASSERT_TRUE(catalogue_->GetPackedCloud(MakeViewName("mug", "upright", "7")).ok());
  ASSERT_EQ(BlobsReadHere(), before + 1) << "a cloud is no blob, or blobs are not counted";
  ASSERT_TRUE(catalogue_->DeleteStablePose("objects/mug/stablePoses/upright", true, "").ok());
  ASSERT_TRUE(catalogue_->DeleteObject("objects/bowl", true, "").ok());
  EXPECT_EQ(BlobsReadHere(), before + 1);
  EXPECT_EQ(catalogue_->counts().views, 0);
  // Counts the records of each kind.
  EXPECT_TRUE(TakePicture(*catalogue_).ok());
  ASSERT_TRUE(catalogue_->CreateStablePose(MakeStablePose("mug", "upright")).ok());
  EXPECT_TRUE(
      absl::IsNotFound(catalogue_->GetPackedCloud(MakeViewName("mug", "upright", "7")).status()));
}

}  // namespace
}  // namespace graspdb::storage
