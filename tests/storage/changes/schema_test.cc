// Migrations, with steps made up for the test.
#include "storage/changes/schema.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gtest/gtest.h"
#include "program/base/uuid.h"
#include "tests/storage/catalogue_fixture.h"

namespace graspdb::storage {
namespace {

class SchemaTest : public ::testing::Test {
 protected:
  void SetUp() override {
    Reopen();
    ASSERT_TRUE(PrepareSchema(*database_, std::nullopt, absl::UnixEpoch()).ok());
    SetSchemaVersion(1);
  }

  void SetSchemaVersion(int version) {
    MetaRecord meta = *ReadMeta(*database_);
    meta.set_schema_version(version);
    Store(meta);
  }

  void Store(const MetaRecord& meta) {
    rocksdb::WriteBatch batch;
    ASSERT_TRUE(database_->Put(Family::kMeta, kMetaKey, meta.SerializeAsString(), batch).ok());
    ASSERT_TRUE(database_->Write(batch).ok());
  }

  void Reopen() {
    database_.reset();
    auto opened = Database::Open(directory_ / "db", {});
    ASSERT_TRUE(opened.ok()) << opened.status();
    database_ = *std::move(opened);
  }

  // A step that appends its number to the record `trace`.
  static Migration Trace(int from) {
    return {from, [from](Database& database, rocksdb::WriteBatch& batch) {
              const auto before = database.Get(Family::kObjects, "trace");
              return database.Put(Family::kObjects, "trace",
                                  (before.ok() ? *before : "") + std::to_string(from), batch);
            }};
  }

  TemporaryDirectory directory_;
  std::unique_ptr<Database> database_;
};

TEST_F(SchemaTest, StepsRunInOrderAndEachIsSaved) {
  MetaRecord meta = *ReadMeta(*database_);
  const std::vector<Migration> steps = {Trace(0), Trace(2), Trace(3), Trace(1)};
  ASSERT_TRUE(Migrate(*database_, meta, steps, 4).ok());
  EXPECT_EQ(meta.schema_version(), 4);
  Reopen();
  EXPECT_EQ(*database_->Get(Family::kObjects, "trace"), "123");
  EXPECT_EQ(ReadMeta(*database_)->schema_version(), 4);
}

TEST_F(SchemaTest, AFailedStepLeavesTheVersionBeforeIt) {
  MetaRecord meta = *ReadMeta(*database_);
  const Migration failing = {
      2, [](Database& database, rocksdb::WriteBatch& batch) {
        EXPECT_TRUE(database.Put(Family::kObjects, "trace", "half", batch).ok());
        return absl::InternalError("cannot");
      }};
  const std::vector<Migration> steps = {Trace(1), failing};
  EXPECT_EQ(Migrate(*database_, meta, steps, 3), absl::InternalError("cannot"));
  EXPECT_EQ(meta.schema_version(), 2);
  EXPECT_EQ(ReadMeta(*database_)->schema_version(), 2);
  EXPECT_EQ(*database_->Get(Family::kObjects, "trace"), "1");
}

TEST_F(SchemaTest, NoStepRunsWhenOneIsMissing) {
  MetaRecord meta = *ReadMeta(*database_);
  const std::vector<Migration> steps = {Trace(1), Trace(3)};
  EXPECT_TRUE(absl::IsFailedPrecondition(Migrate(*database_, meta, steps, 4)));
  EXPECT_EQ(ReadMeta(*database_)->schema_version(), 1);
  EXPECT_TRUE(absl::IsNotFound(database_->Get(Family::kObjects, "trace").status()));
}

TEST_F(SchemaTest, ADatabaseOfTheCurrentVersionWithoutAnIdGetsOne) {
  MetaRecord meta = *ReadMeta(*database_);
  meta.set_schema_version(kSchemaVersion);
  meta.clear_catalog_id();
  Store(meta);
  const auto prepared = PrepareSchema(*database_, std::nullopt, absl::UnixEpoch());
  ASSERT_TRUE(prepared.ok()) << prepared.status();
  EXPECT_TRUE(IsUuid4(prepared->catalog_id())) << prepared->catalog_id();
  Reopen();
  EXPECT_EQ(ReadMeta(*database_)->SerializeAsString(), prepared->SerializeAsString());
}

TEST_F(SchemaTest, PublishedStepsMigrateFrom1ToTheCurrentVersion) {
  for (int version = 1; version < kSchemaVersion; ++version) {
    int steps = 0;
    for (const Migration& step : Migrations()) steps += step.from_version == version ? 1 : 0;
    EXPECT_EQ(steps, 1) << version;
  }
}

}  // namespace
}  // namespace graspdb::storage
