// Staged views that are read and described again, and commits that are cancelled
// or of an upload that was deleted.
#include <string>
#include <utility>
#include <vector>

#include "gtest/gtest.h"
#include "storage/uploads/uploads.h"
#include "tests/storage/catalogue_fixture.h"

namespace graspdb::storage {
namespace {

constexpr absl::Time kStagedViewsNow = absl::FromUnixSeconds(1'800'000'000);

class StagedViewsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(catalogue_->CreateObject(MakeObject("mug")).ok());
    ASSERT_TRUE(catalogue_->CreateStablePose(MakeStablePose("mug", "upright")).ok());
    UploadRecord wanted;
    wanted.set_name("uploads/monday");
    auto created = uploads().Create(wanted, kStagedViewsNow);
    ASSERT_TRUE(created.ok()) << created.status();
    upload_ = *std::move(created);
    for (int i = 0; i < 3; ++i) {
      ASSERT_TRUE(uploads().Stage(upload_, MakeView(ViewNameOf(i), i)).ok());
    }
  }

  static std::string ViewNameOf(int i) {
    return "objects/mug/stablePoses/upright/views/" + std::to_string(i);
  }
  static DescriptorUpdate UpdateOf(int i) {
    DescriptorRecord descriptor;
    descriptor.set_parameters("other parameters");
    return {ViewNameOf(i), "", {descriptor}};
  }
  absl::Status Replace(const std::vector<DescriptorUpdate>& updates) {
    return uploads().ReplaceDescriptors(upload_, updates);
  }
  static bool IsReplaced(const ViewRecord& view) {
    return view.descriptors_size() == 1 && view.descriptors(0).parameters() == "other parameters";
  }
  Uploads& uploads() { return catalogue_->uploads(); }

  TemporaryDirectory directory_;
  std::unique_ptr<Catalogue> catalogue_ = OpenOrDie(directory_ / "db");
  UploadRecord upload_;
};

TEST_F(StagedViewsTest, ACommitThatIsCancelledChangesNothingAndMayBeRepeated) {
  const Picture before = *TakePicture(*catalogue_);
  for (const int calls : {1, 2}) {  // at the first view, and before the write
    int left = calls;
    const auto cancelled = uploads().Commit(upload_, false, [&left] { return --left == 0; });
    EXPECT_TRUE(absl::IsCancelled(cancelled.status())) << cancelled.status();
    EXPECT_EQ(left, 0);
    EXPECT_EQ(*TakePicture(*catalogue_), before);
    EXPECT_EQ(uploads().CountsOf(*uploads().Get(upload_.name()))->views, 3);
  }
  ASSERT_TRUE(uploads().Stage(upload_, MakeView(ViewNameOf(3), 3)).ok());
  const auto committed = uploads().Commit(upload_, false, [] { return false; });
  ASSERT_TRUE(committed.ok()) << committed.status();
  EXPECT_EQ(committed->created_count(), 4);
  EXPECT_TRUE(TakePicture(*catalogue_).ok());
}

TEST_F(StagedViewsTest, ACommitIsOfTheUploadAndNotOfItsName) {
  ASSERT_TRUE(uploads().Delete(upload_.name()).ok());
  EXPECT_TRUE(absl::IsNotFound(uploads().Commit(upload_, false).status()));
  UploadRecord wanted;
  wanted.set_name(upload_.name());
  const UploadRecord next = *uploads().Create(wanted, kStagedViewsNow);
  ASSERT_TRUE(uploads().Stage(next, MakeView(ViewNameOf(0), 0)).ok());
  EXPECT_TRUE(absl::IsAborted(uploads().Commit(upload_, false).status()));
  EXPECT_EQ(uploads().CountsOf(next)->views, 1) << "the other one is open";
  ASSERT_TRUE(uploads().Commit(next, false).ok());
  EXPECT_TRUE(absl::IsAborted(uploads().Commit(upload_, false).status()));
}

TEST_F(StagedViewsTest, ACommittedUploadIsNotCancelled) {
  ASSERT_TRUE(uploads().Commit(upload_, false).ok());
  EXPECT_TRUE(uploads().Commit(upload_, false, [] { return true; }).ok());
}

TEST_F(StagedViewsTest, ReplacedDescriptorsAreNoChangeAndArePublished) {
  const Picture before = *TakePicture(*catalogue_);
  ASSERT_TRUE(Replace({UpdateOf(0), UpdateOf(2)}).ok());
  EXPECT_EQ(*TakePicture(*catalogue_), before);
  catalogue_.reset();
  catalogue_ = OpenOrDie(directory_ / "db");
  const auto staged = uploads().GetStaged(upload_, ViewNameOf(2));
  ASSERT_TRUE(staged.ok()) << staged.status();
  EXPECT_TRUE(IsReplaced(staged->record));
  EXPECT_EQ(staged->packed_cloud, MakeView(ViewNameOf(2), 2).packed_cloud);

  ASSERT_TRUE(uploads().Commit(upload_, false).ok());
  for (const int i : {0, 1, 2}) EXPECT_EQ(IsReplaced(*catalogue_->GetView(ViewNameOf(i))), i != 1);
  EXPECT_EQ(*catalogue_->GetPackedCloud(ViewNameOf(2)), staged->packed_cloud);
  EXPECT_TRUE(TakePicture(*catalogue_).ok());
}

TEST_F(StagedViewsTest, OnlyStagedViewsAreVisitedReadAndReplaced) {
  ASSERT_TRUE(
      uploads().StageError(upload_, ViewNameOf(9), absl::InvalidArgumentError("no points")).ok());
  std::vector<std::string> visited;
  const auto visit = [&](const ViewRecord& view) {
    visited.push_back(view.name());
    return visited.size() < 3 ? absl::OkStatus() : absl::CancelledError("enough");
  };
  EXPECT_TRUE(absl::IsCancelled(uploads().ForEachView(upload_, visit)));
  EXPECT_EQ(visited, (std::vector<std::string>{ViewNameOf(0), ViewNameOf(1), ViewNameOf(2)}));
  for (const int i : {7, 9}) {
    EXPECT_TRUE(absl::IsNotFound(uploads().GetStaged(upload_, ViewNameOf(i)).status()));
    EXPECT_TRUE(absl::IsNotFound(Replace({UpdateOf(0), UpdateOf(i)})));
  }
  EXPECT_FALSE(IsReplaced(uploads().GetStaged(upload_, ViewNameOf(0))->record));
  EXPECT_TRUE(Replace({}).ok());

  ASSERT_TRUE(uploads().Commit(upload_, true).ok());
  EXPECT_TRUE(absl::IsFailedPrecondition(Replace({UpdateOf(0)})));
  EXPECT_TRUE(absl::IsNotFound(uploads().GetStaged(upload_, ViewNameOf(0)).status()));
}

}  // namespace
}  // namespace graspdb::storage
