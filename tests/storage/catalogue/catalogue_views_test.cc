#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "storage/catalogue/catalogue.h"
#include "tests/storage/catalogue_fixture.h"

namespace graspdb::storage {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class CatalogueViewsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(catalogue_->CreateObject(MakeObject("mug")).ok());
    ASSERT_TRUE(catalogue_->CreateStablePose(MakeStablePose("mug", "upright")).ok());
  }

  static std::string Name(const std::string& id) {
    return "objects/mug/stablePoses/upright/views/" + id;
  }

  TemporaryDirectory directory_;
  std::unique_ptr<Catalogue> catalogue_ = OpenOrDie(directory_ / "db");
};

TEST_F(CatalogueViewsTest, StoredViewIsReadBackWithItsCloud) {
  for (const std::size_t cloud_bytes : {1U, 500U, 300'000U}) {  // inline and in a blob file
    const NewView view = MakeView(Name(std::to_string(cloud_bytes)), 1, cloud_bytes);
    const auto outcome = catalogue_->PutView(view);
    ASSERT_TRUE(outcome.ok()) << outcome.status();
    EXPECT_EQ(*outcome, PutViewOutcome::kCreated);
    auto record = catalogue_->GetView(view.record.name());
    ASSERT_TRUE(record.ok());
    EXPECT_TRUE(record->has_create_time());
    record->clear_create_time();
    EXPECT_EQ(record->SerializeAsString(), view.record.SerializeAsString());
    EXPECT_EQ(*catalogue_->GetPackedCloud(view.record.name()), view.packed_cloud);
  }
  EXPECT_EQ(catalogue_->counts().views, 3);
}

TEST_F(CatalogueViewsTest, AViewNeedsItsStablePose) {
  const auto orphan = catalogue_->PutView(MakeView("objects/mug/stablePoses/lying/views/0"));
  EXPECT_EQ(orphan.status().code(), absl::StatusCode::kNotFound);
  EXPECT_THAT(std::string(orphan.status().message()), HasSubstr("stablePoses/lying"));
}

TEST_F(CatalogueViewsTest, TheSameViewAgainChangesNothing) {
  ASSERT_TRUE(catalogue_->PutView(MakeView(Name("0"), 1)).ok());
  const std::int64_t revision = catalogue_->revision();
  const auto again = catalogue_->PutView(MakeView(Name("0"), 1));
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(*again, PutViewOutcome::kExisting);
  EXPECT_EQ(catalogue_->revision(), revision);
  EXPECT_EQ(catalogue_->counts().views, 1);
}

TEST_F(CatalogueViewsTest, OtherContentUnderATakenNameIsRejected) {
  ASSERT_TRUE(catalogue_->PutView(MakeView(Name("0"), 1)).ok());
  const auto other = catalogue_->PutView(MakeView(Name("0"), 2));
  EXPECT_EQ(other.status().code(), absl::StatusCode::kAlreadyExists);
  EXPECT_EQ(catalogue_->GetView(Name("0"))->content_digest(), "digest 1");
  EXPECT_EQ(*catalogue_->GetPackedCloud(Name("0")), MakeView(Name("0"), 1).packed_cloud);
}

TEST_F(CatalogueViewsTest, ViewWithoutDigestOrCloudIsRejected) {
  NewView no_digest = MakeView(Name("0"));
  no_digest.record.clear_content_digest();
  EXPECT_TRUE(absl::IsInvalidArgument(catalogue_->PutView(no_digest).status()));
  NewView no_cloud = MakeView(Name("0"));
  no_cloud.packed_cloud.clear();
  EXPECT_TRUE(absl::IsInvalidArgument(catalogue_->PutView(no_cloud).status()));
}

TEST_F(CatalogueViewsTest, ABulkGivesEveryNewViewItsRevision) {
  ASSERT_TRUE(catalogue_->PutView(MakeView(Name("b"), 2)).ok());
  const std::int64_t before = catalogue_->revision();
  const std::vector<NewView> views = {MakeView(Name("a"), 1), MakeView(Name("b"), 2),
                                      MakeView(Name("c"), 3), MakeView(Name("a"), 1)};
  const auto outcomes = catalogue_->PutViews(views);
  ASSERT_TRUE(outcomes.ok()) << outcomes.status();
  EXPECT_THAT(*outcomes, ElementsAre(PutViewOutcome::kCreated, PutViewOutcome::kExisting,
                                     PutViewOutcome::kCreated, PutViewOutcome::kExisting));
  EXPECT_EQ(catalogue_->revision(), before + 2);
  const auto changes = catalogue_->ReadChanges(before, 10);
  ASSERT_TRUE(changes.ok());
  ASSERT_EQ(changes->size(), 2U);
  EXPECT_EQ((*changes)[0].mutations(0).key(), Name("a"));
  EXPECT_EQ((*changes)[1].mutations(0).key(), Name("c"));
  EXPECT_EQ(catalogue_->counts().views, 3);
}

TEST_F(CatalogueViewsTest, ABulkWithOneBadViewStoresNone) {
  const std::int64_t before = catalogue_->revision();
  const std::vector<NewView> views = {MakeView(Name("a"), 1), MakeView(Name("b"), 2),
                                      MakeView(Name("a"), 3)};
  const auto outcomes = catalogue_->PutViews(views);
  EXPECT_EQ(outcomes.status().code(), absl::StatusCode::kAlreadyExists);
  EXPECT_THAT(std::string(outcomes.status().message()), HasSubstr(Name("a")));
  EXPECT_EQ(catalogue_->revision(), before);
  EXPECT_TRUE(absl::IsNotFound(catalogue_->GetView(Name("b")).status()));
  EXPECT_TRUE(catalogue_->PutViews({})->empty());
}

TEST_F(CatalogueViewsTest, DeletedViewRemovesItsCloudAndCanBeTaughtAgain) {
  ASSERT_TRUE(catalogue_->PutView(MakeView(Name("0"), 1)).ok());
  ASSERT_TRUE(catalogue_->DeleteView(Name("0")).ok());
  EXPECT_TRUE(absl::IsNotFound(catalogue_->GetView(Name("0")).status()));
  EXPECT_TRUE(absl::IsNotFound(catalogue_->GetPackedCloud(Name("0")).status()));
  EXPECT_TRUE(absl::IsNotFound(catalogue_->DeleteView(Name("0"))));
  EXPECT_TRUE(absl::IsInvalidArgument(catalogue_->DeleteView("objects/mug")));
  ASSERT_TRUE(catalogue_->PutView(MakeView(Name("0"), 2)).ok());
  EXPECT_EQ(*catalogue_->GetPackedCloud(Name("0")), MakeView(Name("0"), 2).packed_cloud);
}

TEST_F(CatalogueViewsTest, ViewsAreListedByPage) {
  for (const char* id : {"2", "0", "1"}) {
    ASSERT_TRUE(catalogue_->PutView(MakeView(Name(id))).ok());
  }
  const auto first = catalogue_->ListViews("objects/mug/stablePoses/upright", 2, "");
  ASSERT_TRUE(first.ok());
  ASSERT_EQ(first->records.size(), 2U);
  EXPECT_EQ(first->records[1].name(), Name("1"));
  EXPECT_TRUE(first->more);
  const auto last = catalogue_->ListViews("objects/mug/stablePoses/upright", 2, Name("1"));
  ASSERT_EQ(last->records.size(), 1U);
  EXPECT_FALSE(last->more);
  EXPECT_TRUE(
      absl::IsNotFound(catalogue_->ListViews("objects/mug/stablePoses/lying", 2, "").status()));
}

TEST_F(CatalogueViewsTest, NewDescriptorsReplaceTheOldInOneChange) {
  ASSERT_TRUE(catalogue_->PutView(MakeView(Name("0"), 1)).ok());
  ASSERT_TRUE(catalogue_->PutView(MakeView(Name("1"), 2)).ok());
  const std::int64_t before = catalogue_->revision();
  DescriptorRecord descriptor;
  descriptor.set_kind("mvfh300");
  descriptor.set_parameters("voxel=2mm");
  descriptor.add_bins(1.0F);
  const std::vector<DescriptorUpdate> updates = {{Name("0"), "digest 1", {descriptor}},
                                                 {Name("1"), "digest 2", {descriptor, descriptor}}};
  const auto revision = catalogue_->ReplaceDescriptors(updates);
  ASSERT_TRUE(revision.ok()) << revision.status();
  EXPECT_EQ(*revision, before + 1);
  EXPECT_EQ(catalogue_->revision(), before + 1);
  const auto view = catalogue_->GetView(Name("0"));
  ASSERT_EQ(view->descriptors_size(), 1);
  EXPECT_EQ(view->descriptors(0).parameters(), "voxel=2mm");
  EXPECT_EQ(view->content_digest(), "digest 1") << "the rest stays";
  EXPECT_EQ(catalogue_->GetView(Name("1"))->descriptors_size(), 2);
  EXPECT_TRUE(TakePicture(*catalogue_).ok());
}

TEST_F(CatalogueViewsTest, NewDescriptorsOfAViewThatIsGoneOrReplacedAreLeftOut) {
  ASSERT_TRUE(catalogue_->PutView(MakeView(Name("0"), 1)).ok());
  ASSERT_TRUE(catalogue_->PutView(MakeView(Name("1"), 2)).ok());
  const std::int64_t before = catalogue_->revision();
  const std::vector<DescriptorUpdate> old = {{Name("9"), "digest 1", {}},
                                             {Name("1"), "digest of another cloud", {}}};
  EXPECT_EQ(*catalogue_->ReplaceDescriptors(old), before);
  EXPECT_EQ(*catalogue_->ReplaceDescriptors({}), before);
  EXPECT_EQ(catalogue_->revision(), before) << "no change without an update";
  const std::vector<DescriptorUpdate> some = {old[0], {Name("0"), "digest 1", {}}, old[1]};
  EXPECT_EQ(*catalogue_->ReplaceDescriptors(some), before + 1);
  EXPECT_EQ(catalogue_->GetView(Name("0"))->descriptors_size(), 0);
  EXPECT_EQ(catalogue_->GetView(Name("1"))->descriptors_size(), 1);
}

TEST_F(CatalogueViewsTest, ForEachSeesOneRevisionInOrderOfNames) {
  for (const char* id : {"2", "0", "1"}) {
    ASSERT_TRUE(catalogue_->PutView(MakeView(Name(id))).ok());
  }
  const std::int64_t before = catalogue_->revision();
  std::vector<std::string> seen;
  RecordVisitor visitor;
  visitor.view = [&](const ViewRecord& view) {
    // Changes meanwhile are not visible, neither added nor deleted views.
    if (seen.empty()) {
      EXPECT_TRUE(catalogue_->PutView(MakeView(Name("00"))).ok());
      EXPECT_TRUE(catalogue_->DeleteView(Name("2")).ok());
    }
    seen.push_back(view.name());
    return absl::OkStatus();
  };
  const auto revision = catalogue_->ForEach(visitor);
  ASSERT_TRUE(revision.ok());
  EXPECT_EQ(*revision, before);
  EXPECT_THAT(seen, ElementsAre(Name("0"), Name("1"), Name("2")));
}

TEST_F(CatalogueViewsTest, ForEachStopsAtAnError) {
  ASSERT_TRUE(catalogue_->PutView(MakeView(Name("0"))).ok());
  ASSERT_TRUE(catalogue_->PutView(MakeView(Name("1"))).ok());
  int calls = 0;
  RecordVisitor visitor;
  visitor.view = [&calls](const ViewRecord&) {
    ++calls;
    return absl::CancelledError("enough");
  };
  const auto revision = catalogue_->ForEach(visitor);
  EXPECT_EQ(revision.status(), absl::CancelledError("enough"));
  EXPECT_EQ(calls, 1);
}

}  // namespace
}  // namespace graspdb::storage
