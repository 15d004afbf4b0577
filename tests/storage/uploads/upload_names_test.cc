// Names of bulk uploads and of their views: used again, and how many there may be.
#include <string>

#include "gtest/gtest.h"
#include "storage/uploads/uploads.h"
#include "tests/storage/catalogue_fixture.h"

namespace graspdb::storage {
namespace {

constexpr absl::Time kNamesNow = absl::FromUnixSeconds(1'800'000'000);

class UploadNamesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(catalogue_->CreateObject(MakeObject("mug")).ok());
    ASSERT_TRUE(catalogue_->CreateStablePose(MakeStablePose("mug", "upright")).ok());
  }

  void Open(std::size_t max_staged_views) {
    catalogue_.reset();
    CatalogueOptions options;
    options.max_staged_views = max_staged_views;
    catalogue_ = OpenOrDie(directory_ / "db", std::move(options));
  }
  UploadRecord Create(const std::string& name) {
    UploadRecord wanted;
    wanted.set_name(name);
    auto created = uploads().Create(wanted, kNamesNow);
    EXPECT_TRUE(created.ok()) << created.status();
    return created.ok() ? *std::move(created) : UploadRecord();
  }
  static std::string ViewNameOf(int i) {
    return "objects/mug/stablePoses/upright/views/" + std::to_string(i);
  }
  absl::Status Stage(const UploadRecord& upload, int i) {
    return uploads().Stage(upload, MakeView(ViewNameOf(i))).status();
  }
  absl::Status StageError(const UploadRecord& upload, int i) {
    return uploads().StageError(upload, ViewNameOf(i), absl::InvalidArgumentError("no points"));
  }
  Uploads& uploads() { return catalogue_->uploads(); }

  TemporaryDirectory directory_;
  std::unique_ptr<Catalogue> catalogue_ = OpenOrDie(directory_ / "db");
};

TEST_F(UploadNamesTest, WhatWasBegunWithADeletedUploadIsNoPartOfTheNextOneOfItsName) {
  const UploadRecord deleted = Create("uploads/monday");
  ASSERT_TRUE(uploads().Delete("uploads/monday").ok());
  EXPECT_TRUE(absl::IsNotFound(Stage(deleted, 0)));
  const UploadRecord next = Create("uploads/monday");
  EXPECT_TRUE(absl::IsAborted(Stage(deleted, 0)));
  EXPECT_TRUE(absl::IsAborted(StageError(deleted, 1)));
  ASSERT_TRUE(Stage(next, 2).ok());
  EXPECT_TRUE(absl::IsAborted(uploads().DigestOf(deleted, ViewNameOf(2)).status()));
  const auto committed = uploads().Commit(*uploads().Get("uploads/monday"), false);
  ASSERT_TRUE(committed.ok()) << committed.status();
  EXPECT_EQ(committed->created_count(), 1);
}

TEST_F(UploadNamesTest, OpenUploadsAreLimited) {
  for (std::size_t i = 0; i < kMaxOpenUploads; ++i) Create("uploads/u" + std::to_string(i));
  UploadRecord wanted;
  wanted.set_name("uploads/monday");
  EXPECT_TRUE(absl::IsResourceExhausted(uploads().Create(wanted, kNamesNow).status()));
  ASSERT_TRUE(uploads().Delete("uploads/u3").ok());
  EXPECT_TRUE(uploads().Create(wanted, kNamesNow).ok());
  EXPECT_TRUE(absl::IsAlreadyExists(uploads().Create(wanted, kNamesNow).status()));
}

TEST_F(UploadNamesTest, ViewsOfAllOpenUploadsAreLimited) {
  Open(3);
  const UploadRecord first = Create("uploads/first");
  const UploadRecord second = Create("uploads/second");
  ASSERT_TRUE(Stage(first, 0).ok());
  ASSERT_TRUE(Stage(first, 1).ok());
  ASSERT_TRUE(StageError(second, 0).ok());
  for (int restart = 0; restart < 2; ++restart) {
    EXPECT_TRUE(absl::IsResourceExhausted(Stage(second, 1)));
    EXPECT_TRUE(absl::IsResourceExhausted(StageError(second, 1)));
    EXPECT_TRUE(Stage(first, 0).ok()) << "it is there already";
    Open(3);
  }
  EXPECT_TRUE(Stage(second, 0).ok()) << "in the place of the error";
  ASSERT_TRUE(uploads().Delete("uploads/first").ok());
  EXPECT_TRUE(Stage(second, 1).ok());
  EXPECT_TRUE(Stage(second, 2).ok());
  EXPECT_TRUE(absl::IsResourceExhausted(Stage(second, 3)));
  ASSERT_TRUE(uploads().Commit(*uploads().Get("uploads/second"), false).ok());
  const UploadRecord third = Create("uploads/third");
  for (int i = 3; i < 6; ++i) EXPECT_TRUE(Stage(third, i).ok());
}

}  // namespace
}  // namespace graspdb::storage
