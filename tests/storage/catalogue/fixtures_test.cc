// Databases that earlier programs wrote: tests/storage/fixtures has one for each version of the
// schema, left by a killed server.
#include <string>

#include "gtest/gtest.h"
#include "program/base/uuid.h"
#include "storage/changes/schema.h"
#include "storage/records/packed_cloud.h"
#include "tests/storage/catalogue_fixture.h"

namespace graspdb::storage {
namespace {

class FixturesTest : public ::testing::TestWithParam<int> {};

// `graspdb import` of `graspdb simulate --parts wedge,flange --step 120 --seed 5`, a cell, and a
// changed object; the one of schema 2 by single views, later ones by a bulk upload.
TEST_P(FixturesTest, DatabaseOfAnEarlierSchemaIsMigratedWithAllItsRecords) {
  const TemporaryDirectory directory;
  const std::string database = directory / "db";
  CopyDatabase(std::string(GRASPDB_FIXTURES) + "/schema_" + std::to_string(GetParam()), database);
  Picture migrated;
  std::string id;
  for (int attempt = 0; attempt < 2; ++attempt) {
    const auto catalogue = OpenOrDie(database);
    EXPECT_EQ(catalogue->schema_version(), kSchemaVersion);
    EXPECT_EQ(catalogue->revision(), GetParam() == 2 ? 12 : 7);
    EXPECT_EQ(catalogue->counts().objects, 2);
    EXPECT_EQ(catalogue->counts().stable_poses, 2);
    EXPECT_EQ(catalogue->counts().views, 6);
    EXPECT_EQ(catalogue->counts().cells, 1);
    EXPECT_EQ(catalogue->GetObject("objects/wedge")->display_name(),
              "Wedge of schema " + std::to_string(GetParam()));
    EXPECT_EQ(catalogue->GetStablePose("objects/flange/stablePoses/hub-up")->symmetry_order(), 4);
    const auto picture = TakePicture(*catalogue);
    ASSERT_TRUE(picture.ok()) << picture.status();
    for (const auto& [name, cloud] : picture->clouds) {
      const auto points = UnpackCloud(cloud);
      ASSERT_TRUE(points.ok()) << name << ": " << points.status();
      EXPECT_EQ(std::ssize(*points), catalogue->GetView(name)->point_count());
    }
    EXPECT_TRUE(IsUuid4(catalogue->id())) << catalogue->id();
    if (attempt == 0) migrated = *picture;
    if (attempt == 0) id = catalogue->id();
    EXPECT_EQ(catalogue->id(), id);
    EXPECT_EQ(*picture, migrated);
  }
}

INSTANTIATE_TEST_SUITE_P(Schemas, FixturesTest, ::testing::Values(2, 3));

}  // namespace
}  // namespace graspdb::storage
