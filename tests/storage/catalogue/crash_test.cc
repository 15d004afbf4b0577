// Killed processes and torn writes: acknowledged changes survive.
#include <sys/wait.h>

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "gtest/gtest.h"
#include "storage/catalogue/catalogue.h"
#include "storage/history/history.h"
#include "tests/storage/catalogue_fixture.h"
#include "tests/storage/child_process.h"
#include "tests/storage/other_process.h"

namespace graspdb::storage {
namespace {

// The file with the newest writes.
std::filesystem::path NewestLog(const std::string& directory) {
  std::filesystem::path newest;
  for (const auto& entry : std::filesystem::directory_iterator(directory)) {
    if (entry.path().extension() == ".log" && entry.path() > newest) newest = entry.path();
  }
  return newest;
}

class CrashTest : public ::testing::Test {
 protected:
  TemporaryDirectory directory_;
  const std::string database_ = directory_ / "db";
  const std::string copy_ = directory_ / "copy";
};

TEST_F(CrashTest, ACopyTakenWhileOpenHoldsEveryAcknowledgedWrite) {
  const auto catalogue = OpenOrDie(database_);
  MakeHistory(*catalogue, [&] {
    CopyDatabase(database_, copy_);
    const auto recovered = TakePicture(*OpenOrDie(copy_));
    ASSERT_TRUE(recovered.ok()) << recovered.status();
    EXPECT_EQ(*recovered, *TakePicture(*catalogue));
  });
}

TEST_F(CrashTest, TornLogGivesAnEarlierRevision) {
  std::vector<Picture> history;
  std::vector<std::uintmax_t> log_sizes;  // when each revision was acknowledged
  auto catalogue = OpenOrDie(database_);
  const auto remember = [&] {
    history.push_back(*TakePicture(*catalogue));
    log_sizes.push_back(std::filesystem::file_size(NewestLog(database_)));
  };
  remember();
  MakeHistory(*catalogue, remember);
  CopyDatabase(database_, copy_);
  catalogue.reset();

  const std::filesystem::path torn = directory_.path() / "torn";
  const std::string log_name = NewestLog(copy_).filename().string();
  const std::uintmax_t full = log_sizes.back();
  ASSERT_GT(full, 50'000U);
  // Small steps through the last write, and large ones through the rest.
  for (std::uintmax_t size = log_sizes.front(); size <= full;
       size += size + 700 > full ? 23 : 1499) {
    CopyDatabase(copy_, torn);
    std::filesystem::resize_file(torn / log_name, size);
    const auto opened = OpenOrDie(torn.string());
    const auto picture = TakePicture(*opened);
    ASSERT_TRUE(picture.ok()) << size << ": " << picture.status();
    std::size_t expected = 0;
    while (expected + 1 < log_sizes.size() && log_sizes[expected + 1] <= size) ++expected;
    ASSERT_EQ(picture->revision, static_cast<std::int64_t>(expected)) << size;
    ASSERT_EQ(*picture, history[expected]) << size;
    // And it continues from there: the same revision number is used again.
    ASSERT_TRUE(opened->CreateCell(MakeCell("after-the-crash")).ok());
    ASSERT_EQ(opened->revision(), static_cast<std::int64_t>(expected) + 1);
  }
}

TEST_F(CrashTest, TornLogIsRemovedByOpen) {
  // The check of the logs relies on it: an old torn log beside a newer one is damage.
  {
    const auto catalogue = OpenOrDie(database_);
    MakeHistory(*catalogue, [] {});
    CopyDatabase(database_, copy_);
  }
  const std::filesystem::path log = NewestLog(copy_);
  std::filesystem::resize_file(log, std::filesystem::file_size(log) - 3);
  const auto opened = OpenOrDie(copy_);
  EXPECT_FALSE(std::filesystem::exists(log));
  ASSERT_TRUE(opened->CreateCell(MakeCell("a")).ok());
  const std::string second = directory_ / "second";
  CopyDatabase(copy_, second);
  EXPECT_EQ(OpenOrDie(second)->revision(), 12) << "eleven and the new one";
}

TEST_F(CrashTest, AcknowledgedChangesSurviveKill9) {
  for (int round = 0; round < 12; ++round) {
    ChildProcess writer("write", database_);
    std::int64_t last = 0;
    for (int i = 0; i < 10 + 17 * round; ++i) {
      const std::optional<std::int64_t> revision = writer.NextRevision();
      ASSERT_TRUE(revision.has_value());
      last = *revision;
    }
    writer.Kill();
    ASSERT_TRUE(WIFSIGNALED(writer.Wait()));
    // It may have acknowledged more before the signal.
    while (const auto later = writer.NextRevision()) last = *later;

    const auto catalogue = OpenOrDie(database_);
    ASSERT_GE(catalogue->revision(), last);
    ASSERT_LE(catalogue->revision(), last + 1) << "at most one write was in progress";
    const auto picture = TakePicture(*catalogue);
    ASSERT_TRUE(picture.ok()) << picture.status();
    for (std::int64_t i = 0; i < last - 2; ++i) {
      ASSERT_EQ(picture->clouds.at(WrittenViewName(i)), WrittenCloud(i));
    }
  }
}

TEST_F(CrashTest, KilledBetweenDeletionAndPurgeAnObjectIsThereOrCanBeBroughtBack) {
  {
    const auto catalogue = OpenOrDie(database_);
    ASSERT_TRUE(catalogue->CreateObject(MakeObject("mug")).ok());
    ASSERT_TRUE(catalogue->CreateStablePose(MakeStablePose("mug", "upright")).ok());
    for (int i = 0; i < 20; ++i) {
      ASSERT_TRUE(catalogue->PutView(MakeView(WrittenViewName(i), i, 5000)).ok());
    }
  }
  const std::map<std::string, std::string> clouds = TakePicture(*OpenOrDie(database_))->clouds;
  for (int round = 0; round < 12; ++round) {
    ChildProcess writer("undelete", database_);
    for (int i = 0; i < 2 + 5 * round; ++i) ASSERT_TRUE(writer.NextRevision().has_value());
    writer.Kill();
    ASSERT_TRUE(WIFSIGNALED(writer.Wait()));
    const auto catalogue = OpenOrDie(database_);
    if (!catalogue->GetObject("objects/mug").ok()) {
      const auto undeleted = catalogue->history().Undelete("objects/mug");
      ASSERT_TRUE(undeleted.ok()) << undeleted.status();
    }
    const auto picture = TakePicture(*catalogue);
    ASSERT_TRUE(picture.ok()) << picture.status();
    ASSERT_EQ(picture->clouds, clouds);
  }
}

}  // namespace
}  // namespace graspdb::storage
