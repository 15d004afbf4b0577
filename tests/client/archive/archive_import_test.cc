// Archives between two servers.
#include <functional>
#include <limits>

#include "client/archive/archive_comparison.h"
#include "files/archives/archive_file.h"
#include "tests/client/archive/archive_fixture.h"

namespace graspdb::client {
namespace {

using ::graspdb::testing::StatusIs;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class ArchiveImportTest : public ArchiveTest {
 protected:
  // The bytes of the answer to a scene with the part, without the revision.
  static std::string Answer(Client& client, const std::string& part) {
    const testing::Frame frame = testing::Photograph(part, {.x = 0.03, .turn_deg = 20}, 5);
    v1::RecognizeRequest request;
    *request.mutable_depth_image() = testing::DepthImageOf(frame);
    *request.mutable_sensor_pose() = testing::PoseMessage(frame.world_sensor);
    request.set_omit_timings(true);
    auto response = client.Recognize(request);
    EXPECT_THAT(response, IsOk());
    EXPECT_GT(response->detections_size(), 0);
    response->clear_catalog_revision();
    return response->SerializeAsString();
  }

  static v1::ReportGraspOutcomeRequest Picks(const std::string& part, int count) {
    v1::ReportGraspOutcomeRequest out;
    out.set_name(PoseOf(part));
    out.set_grasp_id(testing::Part(part).grasps.front().grasp_id());
    out.set_outcome(v1::GRASP_OUTCOME_PICKED);
    out.set_count(count);
    return out;
  }

  static std::int64_t PicksOf(Client& client) {
    const auto status = client.GetCatalogStatus();
    EXPECT_THAT(status, IsOk());
    return status->picked_count();
  }

  // The archive with changed stable poses.
  Opened Changed(const Opened& archive, const std::function<void(v1::StablePose&)>& change) const {
    auto writer = files::ArchiveWriter::Create(Path("changed.graspdb"));
    EXPECT_THAT(writer, IsOk());
    for (std::int64_t at = files::ArchiveFile::kFirstRecord; at < archive.file->size();) {
      auto item = archive.file->ReadAt(at);
      EXPECT_THAT(item, IsOk());
      if (item->record.has_stable_pose()) change(*item->record.mutable_stable_pose());
      EXPECT_THAT(writer->Add(item->record), IsOk());
      at = item->next;
    }
    EXPECT_THAT(writer->Finish(), IsOk());
    return Open("changed.graspdb");
  }
};

TEST_F(ArchiveImportTest, AnotherServerGivesTheSameAnswersAndTheSameArchive) {
  DeclareAndTeach(from_, "wedge");
  DeclareAndTeach(from_, "l-bracket", /*estimated=*/true);
  ASSERT_THAT(from_.ReportGraspOutcome(Picks("wedge", 12)), IsOk());
  const Opened exported = Export(from_, "a.graspdb");
  const auto counts = Import(to_, exported);
  ASSERT_THAT(counts, IsOk());
  EXPECT_EQ(counts->created_objects, 2);
  EXPECT_EQ(counts->created_stable_poses, 2);
  EXPECT_EQ(counts->created_views, 6);
  EXPECT_EQ(counts->raised_outcomes, 1);
  EXPECT_EQ(Answer(to_, "wedge"), Answer(from_, "wedge"));
  EXPECT_EQ(Answer(to_, "l-bracket"), Answer(from_, "l-bracket"));

  const Opened again = Export(to_, "b.graspdb");
  ASSERT_EQ(again.index.entries.size(), exported.index.entries.size());
  for (std::size_t i = 0; i < again.index.entries.size(); ++i) {
    EXPECT_EQ(again.index.entries[i].name, exported.index.entries[i].name);
    auto a = exported.file->ReadAt(exported.index.entries[i].offset);
    auto b = again.file->ReadAt(again.index.entries[i].offset);
    ASSERT_THAT(a, IsOk());
    ASSERT_THAT(b, IsOk());
    for (v1::ArchiveRecord* record : {&a->record, &b->record}) {
      if (record->has_object()) *record->mutable_object() = ContentOf(record->object());
      if (record->has_stable_pose()) {
        *record->mutable_stable_pose() = ContentOf(record->stable_pose());
      }
      if (record->has_view()) record->mutable_view()->clear_create_time();
    }
    EXPECT_EQ(a->record.SerializeAsString(), b->record.SerializeAsString())
        << again.index.entries[i].name;
  }
}

TEST_F(ArchiveImportTest, TheSameCatalogueGivesTheSameBytes) {
  DeclareAndTeach(from_, "wedge");
  Export(from_, "a.graspdb");
  Export(from_, "b.graspdb");
  EXPECT_EQ(files::BytesOf(Path("a.graspdb")), files::BytesOf(Path("b.graspdb")));
}

TEST_F(ArchiveImportTest, AnExportWithoutViewsCanBeInterrupted) {
  Declare(from_, "wedge");
  const ExportWatch watch = {.report = {}, .cancelled = [] { return true; }};
  EXPECT_THAT(ExportArchive(from_, {}, Path("a.graspdb"), watch),
              StatusIs(absl::StatusCode::kCancelled));
  EXPECT_FALSE(std::filesystem::exists(Path("a.graspdb")));
}

TEST_F(ArchiveImportTest, AnExportKeepsAFileThatAppearsMeanwhile) {
  DeclareAndTeach(from_, "wedge");
  const auto make_file = [&](std::int64_t /*done*/, std::int64_t /*total*/) {
    folder_.Write("a.graspdb", "of another program");
  };
  EXPECT_THAT(
      ExportArchive(from_, {}, Path("a.graspdb"), {.report = make_file, .cancelled = nullptr}),
      StatusIs(absl::StatusCode::kAlreadyExists, HasSubstr("choose another file")));
  EXPECT_EQ(files::BytesOf(Path("a.graspdb")), "of another program");
}

TEST_F(ArchiveImportTest, AllViewsAppearInOneRevision) {
  DeclareAndTeach(from_, "wedge");
  const Opened exported = Export(from_, "a.graspdb");
  ASSERT_THAT(Import(to_, exported), IsOk());
  // Object, stable pose, views.
  EXPECT_EQ(RevisionOf(to_), 3);
}

TEST_F(ArchiveImportTest, ASecondImportChangesNothing) {
  DeclareAndTeach(from_, "wedge");
  ASSERT_THAT(from_.ReportGraspOutcome(Picks("wedge", 12)), IsOk());
  const Opened exported = Export(from_, "a.graspdb");
  ASSERT_THAT(Import(to_, exported), IsOk());
  const std::int64_t revision = RevisionOf(to_);
  const ArchiveComparison comparison = Compare(to_, exported);
  EXPECT_EQ(comparison.CountOf(ArchiveState::kSame), 5);
  EXPECT_THAT(UploadIdsOf(exported.index, comparison), IsEmpty());
  ASSERT_THAT(Import(to_, exported), IsOk());
  EXPECT_EQ(RevisionOf(to_), revision);
  EXPECT_EQ(PicksOf(to_), 12);
}

TEST_F(ArchiveImportTest, CountsOfPicksAreRaisedAndNotAdded) {
  DeclareAndTeach(from_, "wedge");
  ASSERT_THAT(from_.ReportGraspOutcome(Picks("wedge", 10'000)), IsOk());
  ASSERT_THAT(from_.ReportGraspOutcome(Picks("wedge", 5'000)), IsOk());
  const Opened exported = Export(from_, "a.graspdb");
  ASSERT_THAT(Import(to_, exported), IsOk());
  EXPECT_EQ(PicksOf(to_), 15'000);
  ASSERT_THAT(to_.ReportGraspOutcome(Picks("wedge", 1)), IsOk());
  ASSERT_THAT(Import(to_, exported), IsOk());
  EXPECT_EQ(PicksOf(to_), 15'001);
}

TEST_F(ArchiveImportTest, CountsOfAGraspAreRaisedOnceHoweverOftenTheFileHasThem) {
  DeclareAndTeach(from_, "wedge");
  ASSERT_THAT(from_.ReportGraspOutcome(Picks("wedge", 12)), IsOk());
  const Opened twice = Changed(Export(from_, "a.graspdb"), [](v1::StablePose& pose) {
    const v1::GraspOutcomeCounts counts = pose.grasp_outcomes(0);
    *pose.add_grasp_outcomes() = counts;
  });
  ASSERT_THAT(Import(to_, twice), IsOk());
  EXPECT_EQ(PicksOf(to_), 12);
}

TEST_F(ArchiveImportTest, CountsBelowZeroAndOfUnknownGraspsAreLeftOut) {
  DeclareAndTeach(from_, "wedge");
  ASSERT_THAT(from_.ReportGraspOutcome(Picks("wedge", 12)), IsOk());
  const Opened exported = Export(from_, "a.graspdb");
  ASSERT_THAT(Import(to_, exported), IsOk());
  const Opened wrong = Changed(exported, [](v1::StablePose& pose) {
    pose.mutable_grasp_outcomes(0)->set_picked_count(std::numeric_limits<std::int64_t>::min());
    v1::GraspOutcomeCounts* unknown = pose.add_grasp_outcomes();
    unknown->set_grasp_id("unknown");
    unknown->set_picked_count(5);
  });
  ASSERT_THAT(Import(to_, wrong), IsOk());
  EXPECT_EQ(PicksOf(to_), 12);
}

TEST_F(ArchiveImportTest, ARecordThatTheServerRejectsIsNamed) {
  Declare(from_, "wedge");
  const Opened wrong = Changed(Export(from_, "a.graspdb"),
                               [](v1::StablePose& pose) { pose.set_symmetry_order(-1); });
  EXPECT_THAT(Import(to_, wrong), StatusIs(absl::StatusCode::kInvalidArgument,
                                           HasSubstr("rejects " + PoseOf("wedge"))));
}

TEST_F(ArchiveImportTest, WithoutOutcomesTheCountsStay) {
  DeclareAndTeach(from_, "wedge");
  ASSERT_THAT(from_.ReportGraspOutcome(Picks("wedge", 7)), IsOk());
  const Opened exported = Export(from_, "a.graspdb");
  ASSERT_THAT(
      ImportArchive(to_, exported.archive(), Compare(to_, exported), {.outcomes = false}, {}),
      IsOk());
  EXPECT_EQ(PicksOf(to_), 0);
}

TEST_F(ArchiveImportTest, AnInterruptedImportHasNoViewsAndIsContinued) {
  DeclareAndTeach(from_, "wedge");
  const Opened exported = Export(from_, "a.graspdb");
  const std::vector<std::string> ids = UploadIdsOf(exported.index, Compare(to_, exported));
  ASSERT_EQ(ids.size(), 1U);
  const UploadWatch watch = {.report = {},
                             .cancelled = [&] { return to_.GetUpload("uploads/" + ids[0]).ok(); }};
  EXPECT_THAT(Import(to_, exported, {}, watch), StatusIs(absl::StatusCode::kCancelled));
  EXPECT_EQ(to_.GetCatalogStatus()->view_count(), 0);
  EXPECT_THAT(to_.GetUpload("uploads/" + ids[0]), IsOk());
  EXPECT_EQ(UploadIdsOf(exported.index, Compare(to_, exported)), ids);
  const auto counts = Import(to_, exported);
  ASSERT_THAT(counts, IsOk());
  EXPECT_EQ(counts->created_objects, 0);
  EXPECT_EQ(counts->created_views, 3);
  EXPECT_EQ(to_.GetCatalogStatus()->view_count(), 3);
  EXPECT_EQ(Answer(to_, "wedge"), Answer(from_, "wedge"));
}

TEST_F(ArchiveImportTest, CreationAndReportsCanBeInterrupted) {
  DeclareAndTeach(from_, "wedge");
  const UploadWatch watch = {.report = {}, .cancelled = [] { return true; }};
  EXPECT_THAT(Import(to_, Export(from_, "a.graspdb"), {}, watch),
              StatusIs(absl::StatusCode::kCancelled));
  EXPECT_EQ(RevisionOf(to_), 0);
  ASSERT_THAT(Import(to_, Export(from_, "b.graspdb")), IsOk());
  ASSERT_THAT(from_.ReportGraspOutcome(Picks("wedge", 12)), IsOk());
  EXPECT_THAT(Import(to_, Export(from_, "c.graspdb"), {}, watch),
              StatusIs(absl::StatusCode::kCancelled));
  EXPECT_EQ(PicksOf(to_), 0);
}

TEST_F(ArchiveImportTest, SomeObjectsOnly) {
  DeclareAndTeach(from_, "wedge");
  DeclareAndTeach(from_, "flange");
  const std::vector<files::ArchiveEntry> one =
      Export(from_, "one.graspdb", {"objects/flange"}).index.entries;
  ASSERT_EQ(one.size(), 5U);  // with a stable pose and three views
  EXPECT_EQ(one.front().name, "objects/flange");
  const Opened both = Export(from_, "both.graspdb");
  ASSERT_THAT(Import(to_, both, {.objects = {"objects/wedge"}}), IsOk());
  EXPECT_THAT(to_.GetObject("objects/wedge"), IsOk());
  EXPECT_THAT(to_.GetObject("objects/flange"), StatusIs(absl::StatusCode::kNotFound));
  EXPECT_THAT(CompareArchive(to_, both.archive(), {.objects = {"objects/nut"}}, {}),
              StatusIs(absl::StatusCode::kNotFound, HasSubstr("has no objects/nut")));
  EXPECT_THAT(ExportArchive(from_, {"objects/nut"}, Path("none.graspdb"), {}),
              StatusIs(absl::StatusCode::kNotFound));
  EXPECT_FALSE(std::filesystem::exists(Path("none.graspdb")));
}

TEST_F(ArchiveImportTest, AViewThatWasTaughtSinceTheComparisonIsAnErrorAndStays) {
  DeclareAndTeach(from_, "wedge");
  ASSERT_THAT(Import(to_, Export(from_, "common.graspdb")), IsOk());
  Teach(from_, "wedge", "turn-8", 90);
  Teach(from_, "wedge", "turn-9", 100);
  const Opened exported = Export(from_, "a.graspdb");
  const ArchiveComparison comparison = Compare(to_, exported);
  Teach(to_, "wedge", "turn-9", 120);
  EXPECT_THAT(ImportArchive(to_, exported.archive(), comparison, {}, {}),
              StatusIs(absl::StatusCode::kAborted, HasSubstr("run the command again")));
  EXPECT_THAT(to_.GetView(PoseOf("wedge") + "/views/turn-8"), IsOk());
  EXPECT_EQ(Count(Compare(to_, exported), files::ArchiveKind::kView, ArchiveState::kConflict), 1);
}

TEST_F(ArchiveImportTest, AChangeSinceTheComparisonIsAnError) {
  DeclareAndTeach(from_, "wedge");
  const Opened exported = Export(from_, "a.graspdb");
  const ArchiveComparison comparison = Compare(to_, exported);
  Declare(to_, "wedge");
  EXPECT_THAT(ImportArchive(to_, exported.archive(), comparison, {}, {}),
              StatusIs(absl::StatusCode::kAborted, HasSubstr("run the command again")));
}

}  // namespace
}  // namespace graspdb::client
