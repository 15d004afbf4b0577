#include <gmock/gmock.h>

#include "absl/strings/str_cat.h"
#include "client/cli/objects/archive_commands.h"

namespace graspdb::client {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;

// An object and conflicts of some of its stable poses.
ArchiveComparison Conflicts(int count, files::ArchiveIndex* index) {
  ArchiveComparison out;
  index->entries.push_back({files::ArchiveKind::kObject, 4, "objects/mug"});
  out.actions.push_back(ArchiveAction::kNothing);
  out.counts[0] = {1, 0, 0, 0, 0};
  for (int i = 0; i < count; ++i) {
    index->entries.push_back(
        {files::ArchiveKind::kStablePose, 5, absl::StrCat("objects/mug/stablePoses/", i)});
    out.actions.push_back(ArchiveAction::kReplace);
    out.differences.push_back({.entry = static_cast<std::size_t>(i) + 1,
                               .state = ArchiveState::kConflict,
                               .action = ArchiveAction::kReplace,
                               .later = LaterChange::kFile});
  }
  out.counts[1][4] = count;
  return out;
}

TEST(ArchiveText, HasATableAndTheDifferences) {
  files::ArchiveIndex index;
  const ArchiveComparison comparison = Conflicts(1, &index);
  EXPECT_EQ(ComparisonText(index, comparison),
            "in the file       same       new     newer     older  conflict\n"
            "objects              1         0         0         0         0\n"
            "stable poses         0         0         0         0         1\n"
            "views                0         0         0         0         0\n"
            "conflict replace   objects/mug/stablePoses/0, changed later in the file\n");
  EXPECT_EQ(CountOf(index, comparison, files::ArchiveKind::kStablePose), 1);
  EXPECT_EQ(CountOf(index, comparison, files::ArchiveKind::kObject), 0);
}

TEST(ArchiveText, ConflictsWithoutADecisionAreNeitherKeptNorReplaced) {
  files::ArchiveIndex index;
  ArchiveComparison comparison = Conflicts(1, &index);
  EXPECT_THAT(ComparisonText(index, comparison), Not(HasSubstr("undecided")));
  comparison.actions.back() = ArchiveAction::kUndecided;
  comparison.differences.back().action = ArchiveAction::kUndecided;
  EXPECT_THAT(ComparisonText(index, comparison),
              AllOf(HasSubstr("conflict undecided objects/mug/stablePoses/0, "),
                    HasSubstr("1 record is undecided, so that an import writes nothing")));
}

TEST(ArchiveText, ListsTheFirstDifferencesAndJsonAllOfThem) {
  files::ArchiveIndex index;
  const ArchiveComparison comparison = Conflicts(25, &index);
  const std::string text = DifferencesText(index, comparison);
  EXPECT_THAT(text, HasSubstr("stablePoses/19,"));
  EXPECT_THAT(text, Not(HasSubstr("stablePoses/20,")));
  EXPECT_THAT(text, EndsWith("and 5 others\n"));
  const google::protobuf::Struct document = ComparisonDocument(index, comparison);
  EXPECT_EQ(document.fields().at("differences").list_value().values_size(), 25);
}

}  // namespace
}  // namespace graspdb::client
