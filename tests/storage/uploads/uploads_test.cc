// Bulk uploads: durable at once, visible together.
#include "storage/uploads/uploads.h"

#include <string>
#include <thread>
#include <vector>

#include "google/protobuf/util/time_util.h"
#include "gtest/gtest.h"
#include "storage/records/resource_name.h"
#include "tests/storage/catalogue_fixture.h"

namespace graspdb::storage {
namespace {

constexpr absl::Time kNow = absl::FromUnixSeconds(1'800'000'000);
constexpr char kUpload[] = "uploads/monday";

std::string ViewNameOf(int i) {
  return "objects/mug/stablePoses/upright/views/" + std::to_string(i);
}

class UploadsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    Open();
    ASSERT_TRUE(catalogue_->CreateObject(MakeObject("mug")).ok());
    ASSERT_TRUE(catalogue_->CreateStablePose(MakeStablePose("mug", "upright")).ok());
  }

  void Open() {
    catalogue_.reset();
    catalogue_ = OpenOrDie(directory_ / "db");
  }

  void Create(const std::string& name = kUpload, bool replace = false) {
    UploadRecord wanted;
    wanted.set_name(name);
    wanted.set_replace(replace);
    const auto created = uploads().Create(wanted, kNow);
    ASSERT_TRUE(created.ok()) << created.status();
  }

  absl::StatusOr<PutViewOutcome> Stage(int i, int seed = 1) {
    const auto upload = uploads().GetOpen(kUpload);
    if (!upload.ok()) return upload.status();
    return uploads().Stage(*upload, MakeView(ViewNameOf(i), seed, 6000));
  }
  absl::Status StageError(int i) {
    return uploads().StageError(*uploads().GetOpen(kUpload), ViewNameOf(i),
                                absl::InvalidArgumentError("no points"));
  }
  void StageAll(int count) {
    for (int i = 0; i < count; ++i) ASSERT_TRUE(Stage(i, i).ok());
  }
  absl::StatusOr<UploadRecord> Commit(bool skip_failed) {
    const auto upload = uploads().Get(kUpload);
    return upload.ok() ? uploads().Commit(*upload, skip_failed) : upload;
  }
  StagedCounts Counts() { return *uploads().CountsOf(*uploads().Get(kUpload)); }
  Uploads& uploads() { return catalogue_->uploads(); }

  TemporaryDirectory directory_;
  std::unique_ptr<Catalogue> catalogue_;
};

TEST_F(UploadsTest, StagedViewsAreNoPartOfTheCatalogue) {
  const Picture before = *TakePicture(*catalogue_);
  Create();
  StageAll(5);
  EXPECT_EQ(*TakePicture(*catalogue_), before);
  EXPECT_TRUE(absl::IsNotFound(catalogue_->GetView(ViewNameOf(0)).status()));
  EXPECT_TRUE(absl::IsNotFound(catalogue_->GetPackedCloud(ViewNameOf(0)).status()));
  EXPECT_EQ(Counts().views, 5);
}

TEST_F(UploadsTest, ACommitPublishesAllViewsInOneRevision) {
  Create();
  StageAll(5);
  const std::int64_t before = catalogue_->revision();
  std::vector<ChangeRecord> notified;
  ASSERT_TRUE(
      catalogue_->Subscribe([&](const ChangeRecord& change) { notified.push_back(change); }).ok());
  const auto committed = Commit(false);
  ASSERT_TRUE(committed.ok()) << committed.status();
  EXPECT_EQ(committed->commit_revision(), before + 1);
  EXPECT_EQ(committed->created_count(), 5);
  EXPECT_EQ(catalogue_->revision(), before + 1);
  ASSERT_EQ(notified.size(), 1U);
  EXPECT_EQ(catalogue_->counts().views, 5);
  for (int i = 0; i < 5; ++i) {
    const NewView view = MakeView(ViewNameOf(i), i, 6000);
    EXPECT_EQ(catalogue_->GetView(ViewNameOf(i))->content_digest(), view.record.content_digest());
    EXPECT_EQ(*catalogue_->GetPackedCloud(ViewNameOf(i)), view.packed_cloud);
  }
  EXPECT_TRUE(TakePicture(*catalogue_).ok());
}

TEST_F(UploadsTest, ACommitMayBeRepeated) {
  Create();
  StageAll(2);
  const auto first = Commit(false);
  const auto second = Commit(false);
  ASSERT_TRUE(first.ok() && second.ok());
  EXPECT_EQ(first->SerializeAsString(), second->SerializeAsString());
  EXPECT_TRUE(absl::IsFailedPrecondition(Stage(7).status()));
  Open();
  EXPECT_EQ(Commit(false)->SerializeAsString(), first->SerializeAsString());
}

TEST_F(UploadsTest, StagedViewsSurviveARestart) {
  Create();
  StageAll(3);
  ASSERT_TRUE(StageError(3).ok());
  Open();
  EXPECT_EQ(Counts().views, 3);
  EXPECT_EQ(Counts().errors, 1);
  EXPECT_EQ(*Stage(0, 0), PutViewOutcome::kExisting);
  const auto items = uploads().ListItems(*uploads().Get(kUpload), 10, ViewNameOf(1));
  ASSERT_TRUE(items.ok()) << items.status();
  ASSERT_EQ(items->records.size(), 2U);
  EXPECT_EQ(items->records[0].view_name, ViewNameOf(2));
  EXPECT_TRUE(items->records[0].error.ok());
  EXPECT_EQ(items->records[1].error, absl::InvalidArgumentError("no points"));
}

TEST_F(UploadsTest, ACrashDuringAnUploadLosesNoStagedView) {
  Create();
  for (int i = 0; i < 6; ++i) {
    ASSERT_TRUE(Stage(i, i).ok());
    CopyDatabase(directory_ / "db", directory_ / "copy");
    const auto copy = OpenOrDie(directory_ / "copy");
    EXPECT_EQ(copy->uploads().CountsOf(*copy->uploads().Get(kUpload))->views, i + 1);
    EXPECT_EQ(copy->counts().views, 0);
  }
  ASSERT_TRUE(Commit(false).ok());
  CopyDatabase(directory_ / "db", directory_ / "copy");
  EXPECT_EQ(*TakePicture(*OpenOrDie(directory_ / "copy")), *TakePicture(*catalogue_));
}

TEST_F(UploadsTest, AViewThatCannotBeTaughtStopsTheCommitUnlessItIsSkipped) {
  Create();
  StageAll(2);
  ASSERT_TRUE(StageError(9).ok());
  const std::int64_t before = catalogue_->revision();
  const absl::Status whole = Commit(false).status();
  EXPECT_TRUE(absl::IsFailedPrecondition(whole)) << whole;
  EXPECT_NE(whole.message().find("views/9: no points"), std::string::npos) << whole;
  EXPECT_EQ(catalogue_->revision(), before);
  const auto rest = Commit(true);
  ASSERT_TRUE(rest.ok()) << rest.status();
  EXPECT_EQ(rest->created_count(), 2);
  EXPECT_EQ(rest->failed_count(), 1);
}

TEST_F(UploadsTest, AViewThatIsSentAgainReplacesItsError) {
  Create();
  ASSERT_TRUE(StageError(0).ok());
  EXPECT_EQ(*Stage(0), PutViewOutcome::kCreated);
  EXPECT_EQ(Counts().errors, 0);
  EXPECT_EQ(Counts().views, 1);
  EXPECT_TRUE(absl::IsAlreadyExists(Stage(0, 2).status()));
}

TEST_F(UploadsTest, AnIdenticalViewIsNotReplaced) {
  Create();
  StageAll(2);
  ASSERT_TRUE(Commit(false).ok());
  const std::int64_t revision = catalogue_->revision();
  const auto before = TakePicture(*catalogue_);
  ASSERT_TRUE(uploads().Delete(kUpload).ok());
  Create(kUpload, true);
  StageAll(2);
  const auto committed = Commit(false);
  ASSERT_TRUE(committed.ok()) << committed.status();
  EXPECT_EQ(committed->existing_count(), 2);
  EXPECT_EQ(committed->replaced_count(), 0);
  EXPECT_EQ(catalogue_->revision(), revision);
  EXPECT_EQ(*TakePicture(*catalogue_), *before);
}

TEST_F(UploadsTest, ViewsAreNotForAStablePoseThatIsCreatedAgain) {
  Create();
  StageAll(2);
  const auto pose = catalogue_->GetStablePose("objects/mug/stablePoses/upright");
  ASSERT_TRUE(pose.ok()) << pose.status();
  ASSERT_TRUE(catalogue_->DeleteObject("objects/mug", true, "").ok());
  ASSERT_TRUE(catalogue_->CreateObject(MakeObject("mug")).ok());
  ASSERT_TRUE(catalogue_->CreateStablePose(MakeStablePose("mug", "upright")).ok());
  const absl::Status refused = Commit(false).status();
  EXPECT_TRUE(absl::IsFailedPrecondition(refused)) << refused;
  EXPECT_NE(refused.message().find("created again"), std::string::npos) << refused;
  const auto committed = Commit(true);
  ASSERT_TRUE(committed.ok()) << committed.status();
  EXPECT_EQ(committed->failed_count(), 2);
  EXPECT_EQ(catalogue_->counts().views, 0);
}

TEST_F(UploadsTest, ATakenNameIsAConflictOrReplaced) {
  ASSERT_TRUE(catalogue_->PutView(MakeView(ViewNameOf(0), 100)).ok());
  ASSERT_TRUE(catalogue_->PutView(MakeView(ViewNameOf(1), 1, 6000)).ok());
  Create();
  StageAll(3);
  const absl::Status conflict = Commit(false).status();
  EXPECT_TRUE(absl::IsFailedPrecondition(conflict)) << conflict;
  EXPECT_NE(conflict.message().find("views/0"), std::string::npos) << conflict;
  ASSERT_TRUE(uploads().Delete(kUpload).ok());

  Create(kUpload, true);
  StageAll(3);
  const auto committed = Commit(false);
  ASSERT_TRUE(committed.ok()) << committed.status();
  EXPECT_EQ(committed->replaced_count(), 1);
  EXPECT_EQ(committed->existing_count(), 1) << "it is identical";
  EXPECT_EQ(committed->created_count(), 1);
  EXPECT_EQ(catalogue_->counts().views, 3);
  EXPECT_EQ(*catalogue_->GetPackedCloud(ViewNameOf(0)),
            MakeView(ViewNameOf(0), 0, 6000).packed_cloud);
  EXPECT_TRUE(TakePicture(*catalogue_).ok());
}

TEST_F(UploadsTest, WhatTheCatalogueHasIsNotPublishedAgain) {
  ASSERT_TRUE(catalogue_->PutView(MakeView(ViewNameOf(1), 1, 6000)).ok());
  const std::int64_t before = catalogue_->revision();
  Create();
  ASSERT_TRUE(Stage(1, 1).ok());
  const auto committed = Commit(false);
  ASSERT_TRUE(committed.ok()) << committed.status();
  EXPECT_EQ(committed->existing_count(), 1);
  EXPECT_EQ(catalogue_->revision(), before);
  EXPECT_TRUE(TakePicture(*catalogue_).ok());
}

TEST_F(UploadsTest, AViewWhoseStablePoseIsGoneIsAConflict) {
  Create();
  StageAll(2);
  ASSERT_TRUE(catalogue_->DeleteObject("objects/mug", true, "").ok());
  EXPECT_TRUE(absl::IsFailedPrecondition(Commit(false).status()));
  const auto committed = Commit(true);
  ASSERT_TRUE(committed.ok()) << committed.status();
  EXPECT_EQ(committed->failed_count(), 2);
  EXPECT_EQ(catalogue_->counts().views, 0);
  Open();
  EXPECT_TRUE(uploads().Get(kUpload)->has_commit_time());
}

TEST_F(UploadsTest, PublishedViewsCanBeDeletedAndTaughtAgain) {
  Create();
  StageAll(3);
  ASSERT_TRUE(Commit(false).ok());
  // The id of an upload may be used again, while the clouds of the first one are in use.
  ASSERT_TRUE(uploads().Delete(kUpload).ok());
  Create();
  ASSERT_TRUE(Stage(5).ok());
  ASSERT_TRUE(uploads().Delete(kUpload).ok());
  EXPECT_EQ(catalogue_->counts().views, 3);
  EXPECT_TRUE(TakePicture(*catalogue_).ok());

  ASSERT_TRUE(catalogue_->DeleteView(ViewNameOf(0)).ok());
  EXPECT_TRUE(TakePicture(*catalogue_).ok());
  ASSERT_TRUE(catalogue_->PutView(MakeView(ViewNameOf(0), 50)).ok());
  EXPECT_TRUE(TakePicture(*catalogue_).ok());
  ASSERT_TRUE(catalogue_->DeleteObject("objects/mug", true, "").ok());
  EXPECT_TRUE(TakePicture(*catalogue_).ok());
}

TEST_F(UploadsTest, SeveralThreadsSendAtTheSameTime) {
  Create();
  std::vector<std::thread> threads;
  threads.reserve(4);
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([this, t] {
      for (int i = 0; i < 25; ++i) EXPECT_TRUE(Stage(4 * i + t, 4 * i + t).ok());
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(Counts().views, 100);
  EXPECT_EQ(Commit(false)->created_count(), 100);
  EXPECT_TRUE(TakePicture(*catalogue_).ok());
}

TEST_F(UploadsTest, ALargeCommitKeepsNoValuesInItsChangeRecord) {
  Create();
  const int count = 3000;
  StageAll(count);
  std::size_t notified = 0;
  const auto count_values = [&](const ChangeRecord& change) {
    for (const Mutation& mutation : change.mutations()) {
      notified += mutation.value().empty() ? 0 : 1;
    }
  };
  ASSERT_TRUE(catalogue_->Subscribe(count_values).ok());
  ASSERT_TRUE(Commit(false).ok());
  EXPECT_EQ(notified, static_cast<std::size_t>(count));  // but in memory
  const auto changes = catalogue_->ReadChanges(catalogue_->revision() - 1, 1);
  ASSERT_TRUE(changes.ok()) << changes.status();
  EXPECT_EQ(changes->front().mutations_size(), 2 * count);
  EXPECT_TRUE(changes->front().mutations(0).value().empty());
  Open();
  EXPECT_EQ(catalogue_->counts().views, count);
}

TEST_F(UploadsTest, OldUploadsAreDeleted) {
  Create("uploads/forgotten");
  Create();
  StageAll(1);
  ASSERT_TRUE(Commit(false).ok());
  // The time of a committed one begins with the commit.
  const absl::Time committed =
      absl::FromUnixNanos(google::protobuf::util::TimeUtil::TimestampToNanoseconds(
          uploads().Get(kUpload)->commit_time()));
  EXPECT_TRUE(uploads().DeleteOlderThan(kNow, committed)->empty());
  const absl::Time later = kNow + absl::Seconds(1);
  EXPECT_EQ(*uploads().DeleteOlderThan(later, committed),
            std::vector<std::string>{"uploads/forgotten"});
  EXPECT_TRUE(uploads().Get(kUpload).ok());
  EXPECT_TRUE(uploads().DeleteOlderThan(later, committed + absl::Seconds(1))->empty());
  const absl::Status missing = uploads().Get(kUpload).status();
  EXPECT_TRUE(absl::IsNotFound(missing));
  EXPECT_EQ(missing.message(),
            std::string("there is no upload ") + kUpload + "; list the existing ones");
  EXPECT_EQ(catalogue_->counts().views, 1);
}

TEST_F(UploadsTest, UnknownUploadsAndInvalidNamesAreErrors) {
  EXPECT_TRUE(absl::IsNotFound(Stage(0).status()));
  EXPECT_TRUE(absl::IsNotFound(Commit(false).status()));
  EXPECT_TRUE(absl::IsNotFound(uploads().Delete(kUpload)));
  EXPECT_TRUE(absl::IsInvalidArgument(uploads().Get("uploads/a/b").status()));
  Create();
  const UploadRecord upload = *uploads().GetOpen(kUpload);
  EXPECT_TRUE(absl::IsInvalidArgument(uploads().Stage(upload, MakeView("views/0")).status()));
  NewView empty = MakeView(ViewNameOf(0));
  empty.packed_cloud.clear();
  EXPECT_TRUE(absl::IsInvalidArgument(uploads().Stage(upload, empty).status()));
}

}  // namespace
}  // namespace graspdb::storage
