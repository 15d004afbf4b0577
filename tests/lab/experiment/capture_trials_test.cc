#include "lab/experiment/trials/capture_trials.h"

#include <gmock/gmock.h>

#include "files/capture_sets/capture_set.h"
#include "files/depth/depth_png.h"
#include "files/messages/scan_message.h"
#include "files/points/point_file.h"
#include "lab/experiment/descriptor_comparison.h"
#include "lab/experiment/experiment.h"
#include "rendering/meshes/mesh_file.h"
#include "rendering/sample_parts.h"
#include "rendering/simulation.h"
#include "tests/files/temporary_folder.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::lab {
namespace {

using ::graspdb::testing::IsOk;
using ::graspdb::testing::StatusIs;
using ::testing::HasSubstr;

// Two parts on a turntable, and a scene of each and of a third one.
class CaptureTrialsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::vector<rendering::Workpiece> parts = rendering::SampleParts();
    parts.resize(3);
    const std::vector<rendering::Workpiece> taught(parts.begin(), parts.begin() + 2);
    auto plan = *rendering::PlanTurntable(taught, {.stand = {}, .azimuth_step_deg = 30});
    const auto scenes = *rendering::PlanRandomScenes(parts, {.stand = {}, .count = 3});
    plan.insert(plan.end(), scenes.begin(), scenes.end());
    ASSERT_THAT(rendering::WriteSimulation(folder_.path(), parts, plan, {}), IsOk());
  }

  // Changes captures.json.
  void Edit(const std::function<void(v1::CaptureSet*)>& change) {
    auto set = files::LoadCaptureSet(folder_.path());
    ASSERT_THAT(set, IsOk());
    change(&*set);
    ASSERT_THAT(files::SaveCaptureSet(folder_.path(), *set), IsOk());
  }

  absl::StatusOr<CaseResult> Run(bool leave_one_out) {
    auto loaded = LoadCaptureTrials(folder_.path(), leave_one_out);
    if (!loaded.ok()) return loaded.status();
    return RunCase({.name = "captures"}, loaded->set, loaded->trials, {});
  }

  const files::TemporaryFolder folder_;
};

TEST_F(CaptureTrialsTest, JudgesQueriesAndExpectsRejectionOfUnknownObjects) {
  const auto result = Run(/*leave_one_out=*/false);
  ASSERT_THAT(result, IsOk());
  const CaseSummary summary = Summarize(*result);
  EXPECT_EQ(summary.known, 2U);
  EXPECT_EQ(summary.posed, 2U);
  EXPECT_EQ(summary.strictly_right, 1);
  EXPECT_EQ(summary.unknown, 1U);
  EXPECT_EQ(summary.unknown_rejected, 1);
}

TEST_F(CaptureTrialsTest, MeasuresPosesByTaughtViewsWithoutMeshes) {
  Edit([](v1::CaptureSet* set) {
    for (v1::CapturedObject& object : *set->mutable_objects()) object.clear_mesh_path();
  });
  const auto result = Run(/*leave_one_out=*/false);
  ASSERT_THAT(result, IsOk());
  EXPECT_EQ(Summarize(*result).strictly_right, 1);
  EXPECT_GT(result->set.shapes[0]->diameter_m, 0.05);
}

// Within the sizes of objects, but not of this one, as in centimetres or inches.
TEST_F(CaptureTrialsTest, AMeshOfAnotherSizeThanTheTaughtViewsIsRejected) {
  const auto set = files::LoadCaptureSet(folder_.path());
  ASSERT_THAT(set, IsOk());
  const auto path = folder_.path() / set->objects(0).mesh_path();
  auto mesh = rendering::LoadMesh(path);
  ASSERT_THAT(mesh, IsOk());
  for (Eigen::Vector3f& v : mesh->vertices) v *= 35.0F;
  ASSERT_THAT(rendering::WriteMeshPly(path, *mesh), IsOk());
  EXPECT_THAT(Run(/*leave_one_out=*/false),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("both must be in metres")));
}

TEST_F(CaptureTrialsTest, ReadsDepthImages) {
  const files::DepthPngCamera camera = {
      .intrinsics = {.width = 2, .height = 1, .fx = 500, .fy = 500, .cx = 0.5, .cy = 0}};
  ASSERT_THAT(files::WriteIntrinsics(folder_.path() / files::kIntrinsicsFile, camera), IsOk());
  ASSERT_THAT(
      files::WriteDepthPng(folder_.path() / "a.png",
                           files::DepthMessage({700, 800}, camera.intrinsics, camera.depth_unit_m)),
      IsOk());
  Edit([](v1::CaptureSet* set) { set->mutable_captures(0)->set_path("a.png"); });
  const auto loaded = LoadCaptureTrials(folder_.path(), /*leave_one_out=*/false);
  ASSERT_THAT(loaded, IsOk());
  const auto trial = loaded->trials.teaching.make(0);
  ASSERT_THAT(trial, IsOk());
  ASSERT_EQ(trial->scan.points.size(), 2U);
  EXPECT_FLOAT_EQ(trial->scan.points[1].z(), 0.8F);
}

// The server rejects it; as a query it would count as a wrong answer.
TEST_F(CaptureTrialsTest, AScanInMillimetresIsRejected) {
  files::PointFile file;
  file.points = {{0.1F, 0, 780}, {0, 0.1F, 790}, {0, 0, 800.0F}};
  file.width = 3;
  file.height = 1;
  ASSERT_THAT(files::WritePcd(folder_.path() / "mm.pcd", file), IsOk());
  Edit([](v1::CaptureSet* set) {
    for (v1::Capture& capture : *set->mutable_captures()) {
      if (capture.split() == v1::Capture::QUERY) capture.set_path("mm.pcd");
    }
  });
  EXPECT_THAT(Run(/*leave_one_out=*/false),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("millimetres")));
}

TEST_F(CaptureTrialsTest, JudgesOnlyObjectsWithoutPoses) {
  Edit([](v1::CaptureSet* set) {
    for (v1::Capture& capture : *set->mutable_captures()) {
      if (capture.split() == v1::Capture::QUERY) capture.clear_object_pose();
    }
  });
  const auto result = Run(/*leave_one_out=*/false);
  ASSERT_THAT(result, IsOk());
  const CaseSummary summary = Summarize(*result);
  EXPECT_EQ(summary.object_right, 1);
  EXPECT_EQ(summary.posed, 0U);
}

// While no pose can be judged, an object that was not found is no wrong pose.
TEST(CaptureTrials, ObjectsThatWereTaughtWithoutPosesHaveNoWrongPoses) {
  const files::TemporaryFolder folder;
  const auto parts = rendering::SampleParts({"wedge", "stepped-block"});
  ASSERT_THAT(parts, IsOk());
  auto plan = *rendering::PlanTurntable(*parts, {.stand = {}, .azimuth_step_deg = 30});
  const auto scenes = *rendering::PlanRandomScenes(*parts, {.stand = {}, .count = 2});
  plan.insert(plan.end(), scenes.begin(), scenes.end());
  ASSERT_THAT(rendering::WriteSimulation(folder.path(), *parts, plan, {.segmented = true}), IsOk());
  files::PointFile nothing;
  nothing.points = {{0, 0, 3.0F}, {0.1F, 0, 3}, {0, 0.1F, 3}};
  nothing.width = 3;
  nothing.height = 1;
  ASSERT_THAT(files::WritePcd(folder.path() / "nothing.pcd", nothing), IsOk());
  auto set = files::LoadCaptureSet(folder.path());
  ASSERT_THAT(set, IsOk());
  for (v1::CapturedObject& object : *set->mutable_objects()) object.clear_mesh_path();
  bool is_first = true;
  for (v1::Capture& capture : *set->mutable_captures()) {
    if (capture.split() == v1::Capture::TEACH) capture.clear_object_pose();
    if (capture.split() == v1::Capture::QUERY && std::exchange(is_first, false)) {
      capture.set_path("nothing.pcd");
    }
  }
  ASSERT_THAT(files::SaveCaptureSet(folder.path(), *set), IsOk());
  const auto loaded = LoadCaptureTrials(folder.path(), /*leave_one_out=*/false);
  ASSERT_THAT(loaded, IsOk());
  const auto result = RunCase({.name = "captures"}, loaded->set, loaded->trials, {});
  ASSERT_THAT(result, IsOk());
  ASSERT_EQ(result->answers.size(), 2U);
  EXPECT_FALSE(result->answers[0].object_right);
  EXPECT_EQ(result->answers[0].file, "nothing.pcd");
  EXPECT_EQ(Summarize(*result).known, 2U);
  EXPECT_EQ(Summarize(*result).posed, 0U);
}

// The only capture of its stable pose is not recognized when it is left out.
TEST_F(CaptureTrialsTest, LeavesOutTheQueriedCapture) {
  Edit([](v1::CaptureSet* set) {
    bool seen = false;
    const std::string alone = set->captures(0).object_id();
    auto* captures = set->mutable_captures();
    captures->erase(std::remove_if(captures->begin(), captures->end(),
                                   [&](const v1::Capture& capture) {
                                     return capture.object_id() == alone &&
                                            std::exchange(seen, true);
                                   }),
                    captures->end());
  });
  const auto result = Run(/*leave_one_out=*/true);
  ASSERT_THAT(result, IsOk());
  ASSERT_EQ(result->answers.size(), 13U);
  EXPECT_FALSE(result->answers[0].object_right);
  for (std::size_t i = 1; i < result->answers.size(); ++i) {
    EXPECT_TRUE(result->answers[i].object_right) << i;
  }
}

TEST_F(CaptureTrialsTest, ComparesDescriptorsOnTaughtObjects) {
  const auto loaded = LoadCaptureTrials(folder_.path(), /*leave_one_out=*/true);
  ASSERT_THAT(loaded, IsOk());
  const auto figures = CompareDescriptors(loaded->set, loaded->trials, {});
  ASSERT_THAT(figures, IsOk());
  for (const DescriptorFigures& f : *figures) {
    EXPECT_EQ(f.query_count, 24U);
    EXPECT_EQ(MeanFalseRecognition(f), 1) << "every other view is 30 degrees off";
  }
}

TEST_F(CaptureTrialsTest, ReportsASetWithoutQueries) {
  Edit([](v1::CaptureSet* set) {
    for (v1::Capture& capture : *set->mutable_captures()) capture.set_split(v1::Capture::TEACH);
  });
  EXPECT_THAT(Run(false),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("--leave-one-out")));
}

TEST_F(CaptureTrialsTest, ACaptureThatIsTaughtIsNotRecognizedToo) {
  Edit([](v1::CaptureSet* set) {
    v1::Capture again = set->captures(0);
    again.set_path("./" + again.path());
    again.set_split(v1::Capture::QUERY);
    *set->add_captures() = again;
  });
  EXPECT_THAT(Run(false),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("would find itself")));
  EXPECT_THAT(LoadCaptureTrials(folder_.path(), /*leave_one_out=*/true), IsOk());
}

TEST_F(CaptureTrialsTest, ReportsASetWithoutTaughtCaptures) {
  Edit([](v1::CaptureSet* set) {
    for (v1::Capture& capture : *set->mutable_captures()) capture.set_split(v1::Capture::QUERY);
  });
  EXPECT_THAT(Run(false),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("the split TEACH")));
}

}  // namespace
}  // namespace graspdb::lab
