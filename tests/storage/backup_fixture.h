// A database, its backups and a folder to restore them to.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "gtest/gtest.h"
#include "storage/backups/backups.h"
#include "storage/catalogue/catalogue.h"
#include "tests/storage/catalogue_fixture.h"
#include "tests/storage/other_process.h"

namespace graspdb::storage {

class BackupTest : public ::testing::Test {
 protected:
  BackupTest() { std::filesystem::create_directory(folder_); }

  // Every record of a restored backup; the restored database is removed again.
  Picture Restored(BackupId id);
  // Numbers of the backups in the folder.
  std::vector<BackupId> Ids() const;

  TemporaryDirectory directory_;
  const std::string database_ = directory_ / "db";
  const std::string restored_ = directory_ / "restored";
  const std::string folder_ = directory_ / "backups";
  Backups backups_{folder_};
};

// With backup 1, of 60 views in several files.
class OneBackupTest : public BackupTest {
 protected:
  void SetUp() override;

  Picture original_;  // at its revision
};

// Stores views WrittenViewName(first), ... with their clouds; creates the stable pose if needed.
void StoreViews(Catalogue& catalogue, std::int64_t first, std::int64_t count);

// With files of 256 KiB.
CatalogueOptions SmallBuffers();

// Bytes of all files below a folder.
std::int64_t BytesOf(const std::filesystem::path& folder);

// The largest file of a folder with that extension ("": any).
std::filesystem::path LargestFile(const std::filesystem::path& folder, std::string_view extension);

void FlipByte(const std::filesystem::path& file, std::size_t offset);

}  // namespace graspdb::storage
