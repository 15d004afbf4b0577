#include "lab/experiment/bigbird_trials.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <numbers>

#include "files/point_file.h"
#include "lab/commands/eval_run.h"
#include "lab/experiment/descriptor_comparison.h"
#include "lab/experiment/experiment.h"
#include "rendering/mesh_file.h"
#include "rendering/sample_parts.h"
#include "tests/files/temporary_folder.h"
#include "tests/lab/datasets/bigbird_folder.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using ::graspdb::testing::IsOk;
using ::graspdb::testing::StatusIs;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr auto kFailedPrecondition = absl::StatusCode::kFailedPrecondition;

Workpiece Sample(const std::string& object) {
  const std::vector<Workpiece> parts = SampleParts();
  return *std::ranges::find(parts, object, &Workpiece::object_id);
}

class BigBirdTrialsTest : public ::testing::Test {
 protected:
  void Write(const std::vector<std::string>& objects, const BigBirdPlan& plan) {
    std::vector<Workpiece> parts;
    parts.reserve(objects.size());
    for (const std::string& object : objects) parts.push_back(Sample(object));
    ASSERT_THAT(WriteBigBird(folder_.path(), parts, plan), IsOk());
  }

  absl::StatusOr<CaptureTrials> Load(const BigBirdOptions& options = {}) const {
    return LoadBigBirdTrials(folder_.path(), options);
  }

  absl::StatusOr<CaseResult> Run(const BigBirdOptions& options = {}) const {
    const auto loaded = Load(options);
    if (!loaded.ok()) return loaded.status();
    return RunCase({.name = "bigbird"}, loaded->set, loaded->trials, {});
  }

  static void ExpectAllRight(const absl::StatusOr<CaseResult>& result, std::size_t asked) {
    ASSERT_THAT(result, IsOk());
    const CaseSummary summary = Summarize(*result);
    EXPECT_EQ(summary.known, asked);
    EXPECT_EQ(summary.posed, asked);
    EXPECT_EQ(summary.object_right, 1);
    EXPECT_EQ(summary.strictly_right, 1);
    EXPECT_LT(summary.mean_rotation_deg, 1);
    EXPECT_LT(summary.mean_translation_mm, 1.5);
  }

  const TemporaryFolder folder_;
};

TEST_F(BigBirdTrialsTest, TheTurnsBetweenTheTaughtOnesAreRecognised) {
  Write({"handle", "l-bracket"}, {.step_deg = 15});
  const auto result = Run({.teach_step_deg = 30});
  ExpectAllRight(result, 24);
  EXPECT_EQ(result->set.taught_count, 2U);
}

TEST_F(BigBirdTrialsTest, DepthMapsDoWhereThereAreNoClouds) {
  Write({"handle", "l-bracket"}, {.step_deg = 15, .with_clouds = false, .upside_down = true});
  ExpectAllRight(Run({.teach_step_deg = 30}), 24);
}

TEST_F(BigBirdTrialsTest, AMeshIsWhatPosesAreMeasuredWith) {
  Write({"hex-nut", "handle"}, {.step_deg = 30, .with_meshes = true, .upside_down = true});
  const auto result = Run({.teach_step_deg = 60});
  ExpectAllRight(result, 12);
  // Beside the axis of the table it is symmetric about its own.
  EXPECT_EQ(result->set.parts[1].object_id, "hex-nut");
  EXPECT_THAT(result->set.shapes[1]->turns_rad,
              ::testing::Contains(::testing::DoubleNear(std::numbers::pi / 3, 1e-6)));
}

TEST_F(BigBirdTrialsTest, AMeshThatIsElsewhereIsRefused) {
  Write({"handle"}, {.step_deg = 90, .with_meshes = true});
  const auto path =
      folder_.path() / "handle" / "textured_meshes" / "optimized_poisson_textured_mesh.ply";
  recognition::Pose away = recognition::Pose::Identity();
  away.translation().z() = 0.2;
  ASSERT_THAT(WriteMeshPly(path, Transformed(LoadMesh(path).value(), away)), IsOk());
  EXPECT_THAT(Load(), StatusIs(kFailedPrecondition, HasSubstr("frame of the turntable")));
}

TEST_F(BigBirdTrialsTest, TheTurnsBetweenViewsAreKnownToDescriptors) {
  Write({"handle", "l-bracket"}, {.step_deg = 30});
  const auto loaded = Load({.teach_step_deg = 60});
  ASSERT_THAT(loaded, IsOk());
  const auto figures = CompareDescriptors(loaded->set, loaded->trials, {});
  ASSERT_THAT(figures, IsOk());
  for (const DescriptorFigures& f : *figures) {
    EXPECT_EQ(f.asked, 12U);
    EXPECT_EQ(MeanFalseRecognition(f), 1) << "every taught view is 30 degrees off";
  }
}

TEST_F(BigBirdTrialsTest, CamerasAndObjectsAreChosen) {
  Write({"handle", "l-bracket"}, {.step_deg = 45, .cameras = {"NP2", "NP3"}});
  const auto one = Load({.objects = {"l-bracket"}, .teach_step_deg = 90});
  ASSERT_THAT(one, IsOk());
  EXPECT_EQ(one->trials.teaching.count, 4U);
  EXPECT_EQ(one->trials.asking.count, 4U);
  const auto both = Load({.cameras = {"NP2", "NP3"}, .teach_step_deg = 90});
  ASSERT_THAT(both, IsOk());
  EXPECT_EQ(both->trials.teaching.count, 16U);
  EXPECT_THAT(Load({.objects = {"mug"}}),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("has no object mug")));
}

TEST_F(BigBirdTrialsTest, TheFolderOfOneObjectWillDo) {
  Write({"handle"}, {.step_deg = 45});
  EXPECT_TRUE(IsBigBird(folder_.path()));
  EXPECT_TRUE(IsBigBird(folder_.path() / "handle"));
  EXPECT_FALSE(IsBigBird(folder_.path() / "handle" / "poses"));
  const auto loaded = LoadBigBirdTrials(folder_.path() / "handle", {.teach_step_deg = 90});
  ASSERT_THAT(loaded, IsOk());
  EXPECT_EQ(loaded->set.parts.front().object_id, "handle");
}

TEST_F(BigBirdTrialsTest, NothingToTeachOrToAskSaysWhatToDo) {
  EXPECT_THAT(Load(), StatusIs(absl::StatusCode::kNotFound, HasSubstr("calibration.h5")));
  Write({"handle"}, {.step_deg = 90});
  EXPECT_THAT(Load({.teach_step_deg = 90}),
              StatusIs(kFailedPrecondition, HasSubstr("teach at larger steps")));
  std::filesystem::remove(folder_.path() / "handle" / "clouds" / "NP3_0.pcd");
  EXPECT_THAT(Load({.teach_step_deg = 360}),
              StatusIs(kFailedPrecondition, HasSubstr("choose another step")));
}

TEST_F(BigBirdTrialsTest, ACloudThatIsCutShortIsNamed) {
  Write({"handle"}, {.step_deg = 90});
  const std::string name = "handle/clouds/NP3_180.pcd";
  const std::string whole = BytesOf(folder_.path() / name);
  folder_.Write(name, whole.substr(0, whole.size() / 2));
  EXPECT_THAT(Run({.teach_step_deg = 180}),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("NP3_180.pcd")));
}

TEST_F(BigBirdTrialsTest, ACloudThatIsElsewhereOrEmptyIsNamed) {
  Write({"handle"}, {.step_deg = 90});
  const auto path = folder_.path() / "handle" / "clouds" / "NP3_180.pcd";
  PointFile file = ReadPointFile(path).value();
  for (Eigen::Vector3f& p : file.points) p *= 1000;
  ASSERT_THAT(WritePcd(path, file), IsOk());
  EXPECT_THAT(Run({.teach_step_deg = 180}),
              StatusIs(kFailedPrecondition,
                       AllOf(HasSubstr("NP3_180.pcd lies"), HasSubstr("must be in metres"))));
  for (Eigen::Vector3f& p : file.points) p.setZero();
  ASSERT_THAT(WritePcd(path, file), IsOk());
  EXPECT_THAT(Run({.teach_step_deg = 180}),
              StatusIs(kFailedPrecondition,
                       AllOf(HasSubstr("nothing is seen of it"), HasSubstr("NP3_180.pcd"))));
}

TEST_F(BigBirdTrialsTest, EvalTakesTheFolder) {
  Write({"handle"}, {.step_deg = 45});
  EvalArguments arguments;
  arguments.inputs = {folder_.path() / "handle"};
  arguments.bigbird.teach_step_deg = 90;
  ::testing::internal::CaptureStdout();
  const absl::Status status = RunEval(arguments);
  const std::string printed = ::testing::internal::GetCapturedStdout();
  EXPECT_THAT(status, IsOk());
  EXPECT_THAT(printed, HasSubstr("bigbird               4 asked  object 100.00 %"));
  arguments.leave_one_out = true;
  EXPECT_THAT(RunEval(arguments), StatusIs(absl::StatusCode::kInvalidArgument));
}

}  // namespace
}  // namespace graspdb::client
