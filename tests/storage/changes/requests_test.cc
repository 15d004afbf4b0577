// Requests that are sent again.
#include "storage/changes/requests.h"

#include <sys/wait.h>

#include <algorithm>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "storage/catalogue/catalogue.h"
#include "storage/changes/schema.h"
#include "tests/storage/catalogue_fixture.h"
#include "tests/storage/child_process.h"
#include "tests/storage/other_process.h"

namespace graspdb::storage {
namespace {

constexpr char kPose[] = "objects/mug/stablePoses/upright";
constexpr char kId[] = "123e4567-e89b-42d3-a456-426614174000";

v1::GraspOutcomeCounts Missed(int count = 1) {
  v1::GraspOutcomeCounts out;
  out.set_grasp_id("top");
  out.set_missed_count(count);
  return out;
}

class RequestsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    Reopen();
    ASSERT_TRUE(catalogue_->CreateObject(MakeObject("mug")).ok());
    ASSERT_TRUE(catalogue_->CreateStablePose(MakeStablePose("mug", "upright")).ok());
  }

  void Reopen() {
    catalogue_.reset();
    catalogue_ = Open(database_);
  }

  std::unique_ptr<Catalogue> Open(const std::string& database) {
    CatalogueOptions options;
    options.clock = [this] { return now_; };
    return OpenOrDie(database, options);
  }

  AddedOutcomes Report(const std::string& id, const std::string& digest = "digest") {
    const auto added = catalogue_->AddGraspOutcomes(kPose, Missed(), {id, digest});
    EXPECT_TRUE(added.ok()) << added.status();
    return added.value_or(AddedOutcomes());
  }

  std::int64_t MissedCount() const {
    const auto record = catalogue_->GetGraspOutcomes(kPose);
    EXPECT_TRUE(record.ok()) << record.status();
    return record->counts_size() == 0 ? 0 : record->counts(0).missed_count();
  }

  TemporaryDirectory directory_;
  const std::string database_ = directory_ / "db";
  absl::Time now_ = absl::FromUnixSeconds(1'700'000'000);
  std::unique_ptr<Catalogue> catalogue_;
};

TEST_F(RequestsTest, ARepeatedRequestGetsTheFirstAnswerAndChangesNothing) {
  const AddedOutcomes first = Report(kId);
  EXPECT_FALSE(first.is_repeated);
  EXPECT_EQ(first.counts.missed_count(), 1);
  Report("another");
  const std::int64_t revision = catalogue_->revision();
  for (int restart = 0; restart < 2; ++restart) {
    const AddedOutcomes again = Report(kId);
    EXPECT_TRUE(again.is_repeated);
    EXPECT_EQ(again.revision, first.revision);
    EXPECT_EQ(again.counts.SerializeAsString(), first.counts.SerializeAsString());
    EXPECT_EQ(catalogue_->revision(), revision);
    EXPECT_EQ(MissedCount(), 2);
    Reopen();
  }
  EXPECT_TRUE(TakePicture(*catalogue_).ok()) << "changes and records agree";
}

TEST_F(RequestsTest, WithoutAnIdEachCounts) {
  Report("");
  Report("");
  EXPECT_EQ(MissedCount(), 2);
}

TEST_F(RequestsTest, ItIsAnsweredEvenWhereItsRecordIsGone) {
  const AddedOutcomes first = Report(kId);
  ASSERT_TRUE(catalogue_->DeleteObject("objects/mug", true, "").ok());
  EXPECT_EQ(Report(kId).revision, first.revision);
}

TEST_F(RequestsTest, AnotherRequestWithItsIdIsRejected) {
  Report(kId);
  const std::int64_t revision = catalogue_->revision();
  const auto other = catalogue_->AddGraspOutcomes(kPose, Missed(2), {kId, "other digest"});
  EXPECT_TRUE(absl::IsAlreadyExists(other.status())) << other.status();
  EXPECT_THAT(std::string(other.status().message()), ::testing::HasSubstr(kId));
  EXPECT_EQ(catalogue_->revision(), revision);
  EXPECT_EQ(MissedCount(), 1);
}

TEST_F(RequestsTest, ARejectedRequestDoesNotUseItsId) {
  EXPECT_FALSE(catalogue_->AddGraspOutcomes("objects/x/stablePoses/y", Missed(), {kId, "a"}).ok());
  EXPECT_FALSE(Report(kId, "b").is_repeated);
}

TEST_F(RequestsTest, AnIdIsForgottenAfterADay) {
  Report(kId);
  now_ += kKeptRequestTime;
  EXPECT_TRUE(Report(kId).is_repeated);
  now_ += absl::Seconds(1);
  EXPECT_FALSE(Report(kId, "other digest").is_repeated);
  EXPECT_TRUE(Report(kId, "other digest").is_repeated) << "known again";
  for (int i = 0; i < 5; ++i) Report("next " + std::to_string(i));
  EXPECT_TRUE(Report(kId, "other digest").is_repeated) << "not forgotten with its first use";
  now_ -= absl::Hours(48);
  EXPECT_TRUE(Report(kId, "other digest").is_repeated) << "the clock was set back";
}

TEST_F(RequestsTest, ACopyTakenAfterTheAnswerHasTheId) {
  const std::string copy = directory_ / "copy";
  const AddedOutcomes first = Report(kId);
  CopyDatabase(database_, copy);
  const auto crashed = Open(copy);
  const auto again = crashed->AddGraspOutcomes(kPose, Missed(), {kId, "digest"});
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(again->revision, first.revision);
  EXPECT_EQ(crashed->revision(), first.revision);
}

TEST(KilledReportsTest, AreCountedOnceWhenTheyAreSentAgain) {
  const TemporaryDirectory directory;
  const std::string database = directory / "db";
  std::int64_t reports = 0;
  for (int round = 0; round < 6; ++round) {
    ChildProcess writer("report", database);
    for (int i = 0; i < 5 + 13 * round; ++i) ASSERT_TRUE(writer.NextRevision().has_value());
    writer.Kill();
    ASSERT_TRUE(WIFSIGNALED(writer.Wait()));
    const auto catalogue = OpenOrDie(database);
    // Two changes made object and stable pose. The last report may have been answered or not.
    reports = catalogue->revision() - 2;
    for (std::int64_t i = std::max<std::int64_t>(0, reports - 50); i < reports; ++i) {
      const auto again = catalogue->AddGraspOutcomes(kPose, Missed(), {WrittenRequestId(i), "x"});
      ASSERT_TRUE(again.ok()) << again.status();
      EXPECT_TRUE(again->is_repeated) << i;
      EXPECT_EQ(again->revision, i + 3);
    }
    EXPECT_EQ(catalogue->GetGraspOutcomes(kPose)->counts(0).missed_count(), reports);
  }
  EXPECT_GT(reports, 200);
}

class KeptRequestsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto opened = Database::Open(directory_ / "db", {});
    ASSERT_TRUE(opened.ok()) << opened.status();
    database_ = *std::move(opened);
    meta_ = *PrepareSchema(*database_, std::nullopt, absl::UnixEpoch());
  }

  // Keeps requests in one batch, with the ids from the next number on.
  void Keep(std::uint64_t count) {
    rocksdb::WriteBatch batch;
    for (std::uint64_t i = 0; i < count; ++i) {
      RequestRecord record;
      record.set_id(std::to_string(meta_.request_count() + 1));
      ASSERT_TRUE(KeepRequest(*database_, record, now_, meta_, batch).ok());
    }
    ASSERT_TRUE(database_->Write(batch).ok());
  }

  bool IsKept(std::uint64_t number) {
    const auto found = FindRequest(*database_, std::to_string(number), "", now_);
    EXPECT_TRUE(found.ok()) << found.status();
    return found->has_value();
  }

  // Rows beside the MetaRecord.
  std::uint64_t Rows() {
    std::uint64_t rows = 0;
    EXPECT_TRUE(database_
                    ->Scan(Family::kMeta, "request", "",
                           [&](std::string_view, std::string_view) -> absl::StatusOr<bool> {
                             ++rows;
                             return true;
                           })
                    .ok());
    return rows;
  }

  TemporaryDirectory directory_;
  std::unique_ptr<Database> database_;
  MetaRecord meta_;
  google::protobuf::Timestamp now_;
};

TEST_F(KeptRequestsTest, OnlyTheNewestAreKept) {
  Keep(1);
  Keep(kKeptRequests - 1);
  EXPECT_TRUE(IsKept(1));
  EXPECT_EQ(Rows(), 2 * kKeptRequests);
  for (int i = 0; i < 3; ++i) Keep(1);
  EXPECT_FALSE(IsKept(3));
  EXPECT_TRUE(IsKept(4));
  EXPECT_TRUE(IsKept(kKeptRequests + 3));
  EXPECT_EQ(Rows(), 2 * kKeptRequests);
}

TEST_F(KeptRequestsTest, OldOnesAreDeletedTwoAtATime) {
  for (int i = 0; i < 6; ++i) Keep(1);
  now_.set_seconds(absl::ToInt64Seconds(kKeptRequestTime) + 1);
  EXPECT_FALSE(IsKept(1));
  EXPECT_EQ(Rows(), 12U);
  Keep(1);
  EXPECT_EQ(Rows(), 10U);
  for (int i = 0; i < 4; ++i) Keep(1);
  EXPECT_EQ(Rows(), 10U) << "five new ones";
  EXPECT_TRUE(IsKept(7));
}

TEST_F(KeptRequestsTest, DamageIsReported) {
  Keep(1);
  rocksdb::WriteBatch batch;
  ASSERT_TRUE(database_->Put(Family::kMeta, "request/1", "no record", batch).ok());
  ASSERT_TRUE(database_->Write(batch).ok());
  EXPECT_TRUE(absl::IsDataLoss(FindRequest(*database_, "1", "", now_).status()));
}

}  // namespace
}  // namespace graspdb::storage
