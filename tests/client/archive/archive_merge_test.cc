// Records that differ between an archive and a server.
#include <algorithm>
#include <optional>

#include "tests/client/archive/archive_fixture.h"

namespace graspdb::client {
namespace {

using ::graspdb::testing::StatusIs;
using ::testing::ElementsAre;

class ArchiveMergeTest : public ArchiveTest {
 protected:
  // Both servers have the same wedge.
  void SetUp() override {
    DeclareAndTeach(from_, "wedge");
    common_.emplace(Export(from_, "common.graspdb"));
    ASSERT_THAT(Import(to_, *common_), IsOk());
    base_.emplace(common_->archive());
  }

  static ArchiveState StateOf(const ArchiveComparison& comparison) {
    for (const ArchiveState state :
         {ArchiveState::kNewer, ArchiveState::kOlder, ArchiveState::kConflict}) {
      if (Count(comparison, files::ArchiveKind::kStablePose, state) == 1) return state;
    }
    return ArchiveState::kSame;
  }

  std::optional<Opened> common_;
  std::optional<OpenArchive> base_;
};

TEST_F(ArchiveMergeTest, ADifferenceIsAConflictAndStaysUnlessReplaced) {
  SetMinScore(from_, "wedge", 0.25);
  const Opened changed = Export(from_, "a.graspdb");
  const ArchiveComparison comparison = Compare(to_, changed);
  EXPECT_EQ(StateOf(comparison), ArchiveState::kConflict);
  EXPECT_EQ(comparison.CountOf(ArchiveState::kConflict), 1);
  EXPECT_EQ(comparison.CountOf(ArchiveState::kSame), 4);
  ASSERT_EQ(comparison.differences.size(), 1U);
  EXPECT_EQ(comparison.differences.front().action, ArchiveAction::kUndecided);
  ASSERT_THAT(Import(to_, changed, {.on_conflict = OnConflict::kKeep}), IsOk());
  EXPECT_EQ(MinScore(to_, "wedge"), 0);
  const auto counts = Import(to_, changed, {.on_conflict = OnConflict::kReplace});
  ASSERT_THAT(counts, IsOk());
  EXPECT_EQ(counts->replaced, 1);
  EXPECT_EQ(MinScore(to_, "wedge"), 0.25);
  EXPECT_EQ(StateOf(Compare(to_, changed)), ArchiveState::kSame);
}

TEST_F(ArchiveMergeTest, AReplacementAlsoClearsFields) {
  SetMinScore(to_, "wedge", 0.5);
  ASSERT_THAT(Import(to_, *common_, {.on_conflict = OnConflict::kReplace}), IsOk());
  EXPECT_EQ(MinScore(to_, "wedge"), 0);
  EXPECT_EQ(StateOf(Compare(to_, *common_)), ArchiveState::kSame);
}

TEST_F(ArchiveMergeTest, TheLaterChangeWinsWhereItIsChosen) {
  SetMinScore(to_, "wedge", 0.125);
  SetMinScore(from_, "wedge", 0.25);  // later
  const Opened changed = Export(from_, "a.graspdb");
  ASSERT_THAT(Import(to_, changed, {.on_conflict = OnConflict::kLater}), IsOk());
  EXPECT_EQ(MinScore(to_, "wedge"), 0.25);
  SetMinScore(to_, "wedge", 0.5);  // later again
  ASSERT_THAT(Import(to_, changed, {.on_conflict = OnConflict::kLater}), IsOk());
  EXPECT_EQ(MinScore(to_, "wedge"), 0.5);
}

TEST_F(ArchiveMergeTest, WithABaseOnlyWhatBothChangedIsAConflict) {
  SetMinScore(from_, "wedge", 0.25);
  const Opened changed = Export(from_, "a.graspdb");
  EXPECT_EQ(StateOf(Compare(to_, changed, {.base = &*base_})), ArchiveState::kNewer);
  SetMinScore(to_, "wedge", 0.5);
  EXPECT_EQ(StateOf(Compare(to_, *common_, {.base = &*base_})), ArchiveState::kOlder);
  EXPECT_EQ(StateOf(Compare(to_, changed, {.base = &*base_})), ArchiveState::kConflict);
  SetMinScore(to_, "wedge", 0.25);
  EXPECT_EQ(StateOf(Compare(to_, changed, {.base = &*base_})), ArchiveState::kSame);
}

TEST_F(ArchiveMergeTest, WithABaseNewerOnesAreReplacedAndOlderOnesKept) {
  SetMinScore(from_, "wedge", 0.25);
  ASSERT_THAT(Import(to_, Export(from_, "a.graspdb"), {.base = &*base_}), IsOk());
  EXPECT_EQ(MinScore(to_, "wedge"), 0.25);
  ASSERT_THAT(Import(to_, *common_, {.base = &*base_}), IsOk());
  EXPECT_EQ(MinScore(to_, "wedge"), 0.25);
}

TEST_F(ArchiveMergeTest, OnlyViewsThatAreMissingAreSent) {
  Teach(from_, "wedge", "turn-9", 100);
  const Opened more = Export(from_, "a.graspdb");
  const ArchiveComparison comparison = Compare(to_, more);
  EXPECT_EQ(Count(comparison, files::ArchiveKind::kView, ArchiveState::kNew), 1);
  EXPECT_EQ(Count(comparison, files::ArchiveKind::kView, ArchiveState::kSame), 3);
  EXPECT_TRUE(comparison.joined_stable_poses.empty());
  const auto counts = Import(to_, more);
  ASSERT_THAT(counts, IsOk());
  EXPECT_EQ(counts->created_views, 1);
}

TEST_F(ArchiveMergeTest, ViewsBesideThoseOfTheServerAreReported) {
  Teach(from_, "wedge", "turn-8", 90);
  Teach(to_, "wedge", "turn-9", 100);
  EXPECT_THAT(Compare(to_, Export(from_, "a.graspdb")).joined_stable_poses,
              ElementsAre(PoseOf("wedge")));
}

TEST_F(ArchiveMergeTest, ViewsBesideConflictingOnesThatStayAreReported) {
  ASSERT_THAT(from_.DeleteView(PoseOf("wedge") + "/views/turn-1"), IsOk());
  Teach(from_, "wedge", "turn-1", 120);
  Teach(from_, "wedge", "turn-9", 100);
  const Opened changed = Export(from_, "a.graspdb");
  EXPECT_THAT(Compare(to_, changed, {.on_conflict = OnConflict::kKeep}).joined_stable_poses,
              ElementsAre(PoseOf("wedge")));
  EXPECT_TRUE(
      Compare(to_, changed, {.on_conflict = OnConflict::kReplace}).joined_stable_poses.empty());
}

TEST_F(ArchiveMergeTest, AReplacedStablePoseWithViewsOfTheServerIsReported) {
  SetMinScore(from_, "wedge", 0.25);
  Teach(to_, "wedge", "turn-9", 100);
  const Opened changed = Export(from_, "a.graspdb");
  EXPECT_THAT(Compare(to_, changed, {.on_conflict = OnConflict::kReplace}).joined_stable_poses,
              ElementsAre(PoseOf("wedge")));
  EXPECT_TRUE(
      Compare(to_, changed, {.on_conflict = OnConflict::kKeep}).joined_stable_poses.empty());
}

TEST_F(ArchiveMergeTest, AViewWithOtherPointsIsAConflict) {
  ASSERT_THAT(from_.DeleteView(PoseOf("wedge") + "/views/turn-1"), IsOk());
  Teach(from_, "wedge", "turn-1", 120);
  const Opened changed = Export(from_, "a.graspdb");
  const ArchiveComparison comparison = Compare(to_, changed);
  EXPECT_EQ(Count(comparison, files::ArchiveKind::kView, ArchiveState::kConflict), 1);
  const ArchiveComparison with_base = Compare(to_, changed, {.base = &*base_});
  EXPECT_EQ(Count(with_base, files::ArchiveKind::kView, ArchiveState::kNewer), 1);
  const auto counts = Import(to_, changed, {.on_conflict = OnConflict::kReplace});
  ASSERT_THAT(counts, IsOk());
  EXPECT_EQ(counts->replaced, 1);
  EXPECT_EQ(to_.GetView(PoseOf("wedge") + "/views/turn-1")->cloud().data(),
            from_.GetView(PoseOf("wedge") + "/views/turn-1")->cloud().data());
}

// The frame of the object may differ where the stable pose does.
TEST_F(ArchiveMergeTest, AKeptStablePoseInConflictGetsNoViews) {
  SetMinScore(from_, "wedge", 0.25);
  Teach(from_, "wedge", "turn-9", 100);
  const Opened changed = Export(from_, "a.graspdb");
  const ComparisonOptions keep = {.on_conflict = OnConflict::kKeep};
  EXPECT_EQ(Compare(to_, changed, keep).left_out_count, 1);
  const ArchiveComparison undecided = Compare(to_, changed);
  EXPECT_EQ(undecided.left_out_count, 0);
  EXPECT_EQ(std::ranges::count(undecided.actions, ArchiveAction::kUndecided), 2);
  const std::int64_t revision = RevisionOf(to_);
  ASSERT_THAT(Import(to_, changed, keep), IsOk());
  EXPECT_EQ(RevisionOf(to_), revision);
  ASSERT_THAT(Import(to_, changed, {.on_conflict = OnConflict::kReplace}), IsOk());
  EXPECT_THAT(to_.GetView(PoseOf("wedge") + "/views/turn-9"), IsOk());
}

TEST_F(ArchiveMergeTest, NothingIsDeleted) {
  ASSERT_THAT(from_.DeleteView(PoseOf("wedge") + "/views/turn-1"), IsOk());
  ASSERT_THAT(Import(to_, Export(from_, "a.graspdb"), {.on_conflict = OnConflict::kReplace}),
              IsOk());
  EXPECT_THAT(to_.GetView(PoseOf("wedge") + "/views/turn-1"), IsOk());
}

TEST_F(ArchiveMergeTest, AReplacementOfARecordThatChangedMeanwhileIsAnError) {
  SetMinScore(from_, "wedge", 0.25);
  const Opened changed = Export(from_, "a.graspdb");
  const ArchiveComparison comparison = Compare(to_, changed, {.on_conflict = OnConflict::kReplace});
  SetMinScore(to_, "wedge", 0.5);
  EXPECT_THAT(ImportArchive(to_, changed.archive(), comparison, {}, {}),
              StatusIs(absl::StatusCode::kAborted));
  EXPECT_EQ(MinScore(to_, "wedge"), 0.5);
}

// Their views may be those of the file already.
TEST_F(ArchiveMergeTest, OneThatChangedMeanwhileKeepsNoOtherFromItsReplacement) {
  DeclareAndTeach(from_, "flange");
  ASSERT_THAT(Import(to_, Export(from_, "both.graspdb")), IsOk());
  SetMinScore(from_, "flange", 0.25);  // the first in the file
  SetMinScore(from_, "wedge", 0.25);
  const Opened changed = Export(from_, "a.graspdb");
  const ArchiveComparison comparison = Compare(to_, changed, {.on_conflict = OnConflict::kReplace});
  SetMinScore(to_, "flange", 0.5);
  EXPECT_THAT(ImportArchive(to_, changed.archive(), comparison, {}, {}),
              StatusIs(absl::StatusCode::kAborted));
  EXPECT_EQ(MinScore(to_, "flange"), 0.5);
  EXPECT_EQ(MinScore(to_, "wedge"), 0.25);
}

}  // namespace
}  // namespace graspdb::client
