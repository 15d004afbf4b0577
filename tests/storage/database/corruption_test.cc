// Flipped bytes: reported, never misread.
#include <filesystem>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "storage/catalogue/catalogue.h"
#include "storage/database/log_check.h"
#include "storage/database/revision_floor.h"
#include "tests/storage/catalogue_fixture.h"
#include "tests/storage/rocksdb_access.h"

namespace graspdb::storage {
namespace {

using ::testing::HasSubstr;

class CorruptionTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto catalogue = OpenOrDie(database_);
    history_.push_back(*TakePicture(*catalogue));
    MakeHistory(*catalogue, [&] { history_.push_back(*TakePicture(*catalogue)); });
  }

  std::vector<std::filesystem::path> Files(std::string_view part) const {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(database_)) {
      if (entry.path().filename().string().find(part) != std::string::npos) {
        files.push_back(entry.path());
      }
    }
    return files;
  }

  // For damage that may hit unused bytes.
  void ExpectWholeOrDataLoss(const absl::StatusOr<Picture>& picture, std::size_t offset) const {
    if (picture.ok()) {
      EXPECT_EQ(*picture, history_.back()) << offset;
    } else {
      EXPECT_EQ(picture.status().code(), absl::StatusCode::kDataLoss)
          << offset << " " << picture.status();
    }
  }

  absl::StatusOr<Picture> ReadCopy() const {
    const auto catalogue = Catalogue::Open(copy_.string());
    if (!catalogue.ok()) return catalogue.status();
    return TakePicture(**catalogue);
  }

  // Opens a copy of the database with one byte of `file` changed.
  absl::StatusOr<Picture> ReadFlipped(const std::filesystem::path& file, std::size_t offset) const {
    CopyDatabase(database_, copy_);
    std::string bytes = ReadBytes(file);
    bytes[offset] = static_cast<char>(bytes[offset] ^ 0x41);
    WriteBytes(copy_ / file.filename(), bytes);
    return ReadCopy();
  }

  TemporaryDirectory directory_;
  const std::string database_ = directory_ / "db";
  const std::filesystem::path copy_ = directory_.path() / "copy";
  std::vector<Picture> history_;
};

TEST_F(CorruptionTest, AfterACleanShutdownEveryFlippedByteInTheLogIsReported) {
  const std::filesystem::path log = Files(".log").at(0);
  const std::size_t size = ReadBytes(log).size();
  ASSERT_GT(size, 50'000U);
  for (std::size_t offset = 0; offset < size;
       offset += (offset < 1000 || offset + 1200 > size) ? 29 : 1499) {
    const auto picture = ReadFlipped(log, offset);
    ASSERT_EQ(picture.status().code(), absl::StatusCode::kDataLoss) << offset;
    ASSERT_THAT(std::string(picture.status().message()), HasSubstr("backup"));
  }
}

TEST_F(CorruptionTest, AfterACrashDamageToTheLastWriteLooksLikeTheCrash) {
  // As if the process had been killed: the floor of the last changes is not written.
  ASSERT_TRUE(WriteRevisionFloor(database_, 0).ok());
  const std::filesystem::path log = Files(".log").at(0);
  const std::string bytes = ReadBytes(log);
  // Only the last write has to be dropped until the log is complete again.
  std::size_t last_begin = bytes.size() - 1;
  while (!InspectLog(bytes.substr(0, last_begin)).complete) --last_begin;
  for (std::size_t offset = last_begin - 400; offset < bytes.size(); offset += 41) {
    const auto picture = ReadFlipped(log, offset);
    if (offset < last_begin) {
      ASSERT_EQ(picture.status().code(), absl::StatusCode::kDataLoss) << offset;
    } else {
      ASSERT_TRUE(picture.ok()) << offset << ": " << picture.status();
      ASSERT_EQ(*picture, history_[history_.size() - 2]) << offset;
    }
  }
}

TEST_F(CorruptionTest, AMissingLogIsReportedAfterACleanShutdown) {
  std::filesystem::remove(Files(".log").at(0));
  for (int attempt = 0; attempt < 2; ++attempt) {
    EXPECT_EQ(Catalogue::Open(database_).status().code(), absl::StatusCode::kDataLoss);
  }
}

TEST_F(CorruptionTest, AFlippedByteInTheRevisionFloorIsReported) {
  const std::filesystem::path floor = std::filesystem::path(database_) / kRevisionFloorFile;
  for (std::size_t offset = 0; offset < ReadBytes(floor).size(); ++offset) {
    EXPECT_EQ(ReadFlipped(floor, offset).status().code(), absl::StatusCode::kDataLoss) << offset;
  }
}

TEST_F(CorruptionTest, AFlippedByteInATableOrBlobFileIsReported) {
  FlushToFiles(database_);
  std::size_t reported = 0;
  for (const char* kind : {".sst", ".blob"}) {
    for (const std::filesystem::path& file : Files(kind)) {
      const std::size_t size = ReadBytes(file).size();
      for (std::size_t offset = 0; offset<size; offset += size> 8000 ? 997 : 31) {
        const auto picture = ReadFlipped(file, offset);
        // Some bytes (properties, padding) are not read; then all records must be the same.
        ExpectWholeOrDataLoss(picture, offset);
        reported += picture.ok() ? 0U : 1U;
      }
    }
  }
  EXPECT_GT(reported, 50U);
}

// With the records in the log (false) and, after a restart, in tables (true).
class ManifestCorruptionTest : public CorruptionTest, public ::testing::WithParamInterface<bool> {};

TEST_P(ManifestCorruptionTest, AFlippedByteInTheManifestIsReportedOrHarmless) {
  if (GetParam()) OpenOrDie(database_);
  const std::vector<std::filesystem::path> manifests = Files("MANIFEST-");
  ASSERT_EQ(manifests.size(), 1U);
  const std::size_t size = ReadBytes(manifests[0]).size();
  for (std::size_t offset = 0; offset < size; offset += 5) {
    ExpectWholeOrDataLoss(ReadFlipped(manifests[0], offset), offset);
  }
}

TEST_P(ManifestCorruptionTest, TruncatedManifestIsReportedOrHarmless) {
  if (GetParam()) OpenOrDie(database_);
  const std::filesystem::path manifest = Files("MANIFEST-").at(0);
  const std::size_t size = ReadBytes(manifest).size();
  for (std::size_t offset = 0; offset < size; offset += 11) {
    CopyDatabase(database_, copy_);
    std::filesystem::resize_file(copy_ / manifest.filename(), offset);
    ExpectWholeOrDataLoss(ReadCopy(), offset);
  }
}

INSTANTIATE_TEST_SUITE_P(LogAndTables, ManifestCorruptionTest, ::testing::Bool());

TEST_F(CorruptionTest, OlderLogMustBeComplete) {
  // Two logs: the newer one from the copy of a database that continued after a restart.
  const std::vector<std::filesystem::path> logs = Files(".log");
  ASSERT_EQ(logs.size(), 1U);
  const std::filesystem::path newer = std::filesystem::path(database_) / "999999.log";
  std::filesystem::copy(logs[0], newer);
  EXPECT_TRUE(CheckLogs(database_).ok());
  std::filesystem::resize_file(logs[0], std::filesystem::file_size(logs[0]) - 5);
  const absl::Status checked = CheckLogs(database_);
  EXPECT_EQ(checked.code(), absl::StatusCode::kDataLoss);
  EXPECT_THAT(std::string(checked.message()), HasSubstr(logs[0].filename().string()));
}

TEST_F(CorruptionTest, MissingFilesAreReported) {
  FlushToFiles(database_);
  for (const char* part : {"CURRENT", "MANIFEST-", ".sst", ".blob"}) {
    for (const std::filesystem::path& file : Files(part)) {
      CopyDatabase(database_, copy_);
      std::filesystem::remove(copy_ / file.filename());
      const absl::Status opened = Catalogue::Open(copy_.string()).status();
      EXPECT_EQ(opened.code(), absl::StatusCode::kDataLoss) << file << " " << opened;
    }
  }
}

TEST_F(CorruptionTest, CurrentFileWithoutATargetIsReported) {
  for (const std::string text : {"", "MANIFEST-999999\n", "MANIFEST-000005", "garbage\n"}) {
    CopyDatabase(database_, copy_);
    WriteBytes(copy_ / "CURRENT", text);
    const absl::Status opened = Catalogue::Open(copy_.string()).status();
    EXPECT_EQ(opened.code(), absl::StatusCode::kDataLoss) << text << " " << opened;
  }
}

}  // namespace
}  // namespace graspdb::storage
