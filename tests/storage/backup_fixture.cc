#include "tests/storage/backup_fixture.h"

#include <utility>

namespace graspdb::storage {

Picture BackupTest::Restored(BackupId id) {
  Picture picture;
  const auto backup = backups_.Restore(id, restored_);
  EXPECT_TRUE(backup.ok()) << backup.status();
  if (!backup.ok()) return picture;
  auto taken = TakePicture(*OpenOrDie(restored_));
  EXPECT_TRUE(taken.ok()) << taken.status();
  if (taken.ok()) picture = *std::move(taken);
  std::filesystem::remove_all(restored_);
  return picture;
}

std::vector<BackupId> BackupTest::Ids() const {
  const auto listed = backups_.List();
  EXPECT_TRUE(listed.ok()) << listed.status();
  std::vector<BackupId> ids;
  if (!listed.ok()) return ids;
  for (const Backup& backup : *listed) ids.push_back(backup.id);
  return ids;
}

void OneBackupTest::SetUp() {
  const auto catalogue = OpenOrDie(database_, SmallBuffers());
  StoreViews(*catalogue, 0, 60);
  ASSERT_TRUE(backups_.Create(*catalogue).ok());
  original_ = *TakePicture(*catalogue);
}

void StoreViews(Catalogue& catalogue, std::int64_t first, std::int64_t count) {
  if (catalogue.revision() == 0) {
    ASSERT_TRUE(catalogue.CreateObject(MakeObject("mug")).ok());
    ASSERT_TRUE(catalogue.CreateStablePose(MakeStablePose("mug", "upright")).ok());
  }
  for (std::int64_t i = first; i < first + count; ++i) {
    NewView view;
    view.record.set_name(WrittenViewName(i));
    view.record.set_content_digest(std::to_string(i));
    view.packed_cloud = WrittenCloud(i);
    const auto stored = catalogue.PutView(view);
    ASSERT_TRUE(stored.ok()) << stored.status();
  }
}

CatalogueOptions SmallBuffers() {
  CatalogueOptions options;
  options.write_buffer_bytes = 256U << 10;
  return options;
}

std::int64_t BytesOf(const std::filesystem::path& folder) {
  std::int64_t bytes = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) bytes += static_cast<std::int64_t>(entry.file_size());
  }
  return bytes;
}

std::filesystem::path LargestFile(const std::filesystem::path& folder, std::string_view extension) {
  std::filesystem::path largest;
  std::uintmax_t bytes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const bool matches = extension.empty() || entry.path().extension() == extension;
    if (!matches || entry.file_size() < bytes) continue;
    largest = entry.path();
    bytes = entry.file_size();
  }
  EXPECT_FALSE(largest.empty()) << folder << " " << extension;
  return largest;
}

void FlipByte(const std::filesystem::path& file, std::size_t offset) {
  std::string bytes = ReadBytes(file);
  bytes[offset] = static_cast<char>(bytes[offset] ^ 0x41);
  WriteBytes(file, bytes);
}

}  // namespace graspdb::storage
