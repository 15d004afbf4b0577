// Figures of the database.
#include "storage/database/database_status.h"

#include <filesystem>
#include <string>

#include "gtest/gtest.h"
#include "storage/catalogue/catalogue.h"
#include "tests/storage/catalogue_fixture.h"

namespace graspdb::storage {
namespace {

std::uintmax_t BytesOfFiles(const std::string& directory, const std::string& extension) {
  std::uintmax_t out = 0;
  for (const auto& entry : std::filesystem::directory_iterator(directory)) {
    if (entry.path().extension() == extension) out += entry.file_size();
  }
  return out;
}

TEST(DatabaseStatus, HasTheSizeOfTheFiles) {
  const TemporaryDirectory directory;
  constexpr int kViews = 100;
  for (const bool is_new : {true, false}) {  // closed, everything is in files
    const auto catalogue = OpenOrDie(directory / "db");
    if (is_new) {
      ASSERT_TRUE(catalogue->CreateObject(MakeObject("mug")).ok());
      ASSERT_TRUE(catalogue->CreateStablePose(MakeStablePose("mug", "upright")).ok());
      for (int i = 0; i < kViews; ++i) {
        const std::string name = "objects/mug/stablePoses/upright/views/" + std::to_string(i);
        ASSERT_TRUE(catalogue->PutView(MakeView(name, i, 20'000)).ok());
      }
      continue;
    }
    const DatabaseStatus status = catalogue->database_status();
    EXPECT_EQ(status.table_bytes, BytesOfFiles(directory / "db", ".sst"));
    EXPECT_EQ(status.blob_bytes, BytesOfFiles(directory / "db", ".blob"));
    EXPECT_GT(status.blob_bytes, kViews * 20'000U);
  }
}

TEST(DatabaseStatus, HasWhyThereIsNoReserveAndChangesSucceedWithoutIt) {
  const TemporaryDirectory directory;
  CatalogueOptions options;
  OpenOrDie(directory / "db", options).reset();
  const std::filesystem::path in_its_place = std::filesystem::path(directory / "db") / "RESERVE";
  std::filesystem::create_directory(in_its_place);
  options.disk_reserve_bytes = 1U << 20;
  const auto catalogue = OpenOrDie(directory / "db", options);
  EXPECT_TRUE(catalogue->CreateObject(MakeObject("mug")).ok());
  EXPECT_TRUE(catalogue->CreateObject(MakeObject("cup")).ok());
  const DatabaseStatus without = catalogue->database_status();
  EXPECT_TRUE(without.write_fault.error.ok()) << without.write_fault.error;
  EXPECT_EQ(without.reserve_error, in_its_place.string() + ": Is a directory");
  std::filesystem::remove(in_its_place);
  catalogue->CheckWrites();
  EXPECT_EQ(catalogue->database_status().reserve_error.find("directory"), std::string::npos);
}

}  // namespace
}  // namespace graspdb::storage
