// Marks: they identify a catalogue and its history.
#include <memory>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/storage/catalogue_fixture.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::storage {
namespace {

using graspdb::testing::StatusIs;

class CatalogueMarkTest : public ::testing::Test {
 protected:
  // A stopped clock: time does not distinguish two histories.
  static absl::StatusOr<std::string> MarkAfter(const std::string& directory,
                                               const std::string& display_name) {
    const auto catalogue = OpenOrDie(directory, {.clock = [] { return absl::FromUnixSeconds(1); }});
    EXPECT_TRUE(catalogue->CreateObject(MakeObject("mug", display_name)).ok());
    return catalogue->MarkOf(catalogue->revision());
  }

  const TemporaryDirectory folder_;
};

TEST_F(CatalogueMarkTest, MarkIsUnchangedByLaterChanges) {
  const auto first = OpenOrDie(folder_ / "a");
  std::vector<std::string> marks = {*first->MarkOf(0)};
  MakeHistory(*first, [&] { marks.push_back(*first->MarkOf(first->revision())); });
  for (std::size_t i = 0; i < marks.size(); ++i) {
    EXPECT_EQ(*first->MarkOf(static_cast<std::int64_t>(i)), marks[i]);
    for (std::size_t j = 0; j < i; ++j) EXPECT_NE(marks[i], marks[j]);
  }
}

TEST_F(CatalogueMarkTest, MarkSurvivesAReopenAndIsSharedByACopy) {
  const std::string mark = *MarkAfter(folder_ / "a", "Mug");
  CopyDatabase(folder_ / "a", folder_ / "b");
  for (const char* name : {"a", "b"}) EXPECT_EQ(*OpenOrDie(folder_ / name)->MarkOf(1), mark);
}

TEST_F(CatalogueMarkTest, DivergedCopiesHaveDifferentMarks) {
  OpenOrDie(folder_ / "a");
  CopyDatabase(folder_ / "a", folder_ / "b");
  EXPECT_NE(*MarkAfter(folder_ / "a", "Mug"), *MarkAfter(folder_ / "b", "Jug"));
}

TEST_F(CatalogueMarkTest, AnotherDatabaseWithTheSameRecordsHasAnotherMark) {
  EXPECT_NE(*MarkAfter(folder_ / "a", "Mug"), *MarkAfter(folder_ / "b", "Mug"));
}

TEST_F(CatalogueMarkTest, FutureRevisionHasNoMark) {
  EXPECT_THAT(OpenOrDie(folder_ / "a")->MarkOf(1),
              StatusIs(absl::StatusCode::kNotFound, ::testing::_));
}

}  // namespace
}  // namespace graspdb::storage
