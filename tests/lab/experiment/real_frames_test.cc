// Frames in a folder with frames.json: rendered here, so that the ground truth is known.
#include "lab/experiment/real_frames.h"

#include <gmock/gmock.h>

#include <fstream>

#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "files/points/point_file.h"
#include "lab/experiment/report/report_json.h"
#include "lab/experiment/report/report_writer.h"
#include "lab/experiment/trials/trial.h"
#include "program/text/read_file.h"
#include "rendering/meshes/mesh_file.h"
#include "rendering/sample_parts.h"
#include "tests/files/temporary_folder.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::lab {
namespace {

using ::graspdb::testing::IsOk;
using ::graspdb::testing::StatusIs;
using recognition::Pose;
using ::testing::HasSubstr;

std::string Rows(const Pose& pose) {
  std::vector<std::string> rows;
  for (Eigen::Index row = 0; row < 4; ++row) {
    const Eigen::RowVector4d r = pose.matrix().row(row);
    rows.push_back(absl::StrFormat("[%.9f,%.9f,%.9f,%.9f]", r[0], r[1], r[2], r[3]));
  }
  return "[" + absl::StrJoin(rows, ",") + "]";
}

class RealFramesTest : public ::testing::Test {
 protected:
  // A bracket on the table, and its entry in the file: its pose, moved by `moved`.
  void WriteFrame(const std::string& object, const Pose& moved) const {
    const auto parts = rendering::SampleParts({"l-bracket"});
    ASSERT_THAT(parts, IsOk());
    ASSERT_THAT(rendering::WriteMeshPly(folder_.path() / "l.ply", parts->front().mesh), IsOk());
    const auto renderer = TrialRenderer::Create(*parts, rendering::KinectV2());
    ASSERT_THAT(renderer, IsOk());
    const Pose world_sensor = rendering::LookAt({0, 0, 0}, 0.8, 40, -90);
    const auto trial = renderer->Render({.path = "",
                                         .split = v1::Capture::QUERY,
                                         .placements = {{.part = 0}},
                                         .world_sensor = world_sensor,
                                         .seed = 1});
    ASSERT_THAT(trial, IsOk());
    files::PointFile file;
    file.points = trial->scan.points;
    file.width = 512;
    file.height = 424;
    ASSERT_THAT(files::WritePcd(folder_.path() / "frame.pcd", file), IsOk());
    WriteFramesJson(absl::StrFormat(R"([{"frame": "frame.pcd", "objects": [{"object": "%s",
      "mesh": "l.ply", "meshUnit": "m", "T_sensor_mesh": %s}]}])",
                                    object, Rows(world_sensor.inverse() * moved)));
  }

  void WriteFramesJson(const std::string& json) const {
    std::ofstream(folder_.path() / "frames.json") << json;
  }

  absl::StatusOr<FrameResult> Recognize() {
    auto frames = LoadFrames(folder_.path());
    if (!frames.ok()) return frames.status();
    frames_ = *std::move(frames);
    auto catalogue = FramesCatalogue::Teach(frames_, {});
    if (!catalogue.ok()) return catalogue.status();
    const auto scan = ReadScan(frames_.front());
    if (!scan.ok()) return scan.status();
    return RecognizeFrame(frames_.front(), *scan, {}, catalogue->get());
  }

  const files::TemporaryFolder folder_;
  std::vector<RealFrame> frames_;
};

TEST_F(RealFramesTest, FindsAnObjectAtItsTruePose) {
  WriteFrame("l-bracket", Pose::Identity());
  const auto result = Recognize();
  ASSERT_THAT(result, IsOk());
  EXPECT_TRUE(result->error.empty()) << result->error;
  ASSERT_EQ(result->instances.size(), 1U);
  EXPECT_TRUE(result->instances[0].found);
  EXPECT_TRUE(result->instances[0].best_is_right);
  EXPECT_GT(result->instances[0].truth.whole.confidence, 0.5);
  EXPECT_GT(result->instances[0].truth.own_share(), 0.9);
  EXPECT_EQ(result->instances[0].rank, 1);
  EXPECT_EQ(result->instances[0].stage(), PoseStage::kAccepted);
  EXPECT_EQ(result->instances[0].by_segments, PoseStage::kBest);
  ASSERT_EQ(result->detections.size(), 1U);
  EXPECT_FALSE(result->detections[0].IsWrong());
  const Pose& sensor_mesh = *result->frame->objects[0].sensor_mesh;
  EXPECT_LT((result->detections[0].sensor_mesh.inverse() * sensor_mesh).translation().norm(),
            0.005);
  const auto json = FramesJson("graspdb eval", {"l-bracket"}, {*result});
  ASSERT_THAT(json, IsOk());
  for (const char* text :
       {"\"right\": true", "\"found\": true", "\"confirmed\": ", "\"features\": {"}) {
    EXPECT_THAT(*json, HasSubstr(text));
  }
}

TEST_F(RealFramesTest, CountsAMisplacedObjectAsMissedAndWrong) {
  WriteFrame("l-bracket", Pose(Eigen::Translation3d(0.15, 0, 0)));
  const auto result = Recognize();
  ASSERT_THAT(result, IsOk());
  ASSERT_EQ(result->instances.size(), 1U);
  EXPECT_FALSE(result->instances[0].found);
  EXPECT_EQ(result->instances[0].lost_by, LostBy::kSegmentation);
  EXPECT_EQ(result->instances[0].stage(), PoseStage::kNone);
  ASSERT_EQ(result->detections.size(), 1U);
  EXPECT_TRUE(result->detections[0].IsWrong());
}

TEST_F(RealFramesTest, AnObjectThatIsNotInTheFrameIsWrongWithoutAPoseError) {
  WriteFrame("l-bracket", Pose::Identity());
  WriteFramesJson(absl::StrFormat(R"([{"frame": "frame.pcd", "objects": []},
    {"frame": "frame.pcd", "objects": [{"object": "l-bracket", "mesh": "l.ply", "meshUnit": "m",
      "T_sensor_mesh": %s}]}])",
                                  Rows(Pose::Identity())));
  const auto result = Recognize();
  ASSERT_THAT(result, IsOk());
  ASSERT_EQ(result->detections.size(), 1U);
  EXPECT_TRUE(result->detections[0].IsWrong());
  const auto json = FramesJson("graspdb eval", {"l-bracket"}, {*result});
  ASSERT_THAT(json, IsOk());
  EXPECT_THAT(*json, HasSubstr("\"add_s_share\": null"));
}

TEST_F(RealFramesTest, AReportHasFiguresStagesAndPoses) {
  WriteFrame("l-bracket", Pose::Identity());
  const auto result = Recognize();
  ASSERT_THAT(result, IsOk());
  ASSERT_THAT(WriteFramesReport(folder_.path(), "graspdb eval", {"l-bracket"}, {*result}), IsOk());
  const auto text = ReadFile(folder_.path() / "report.json", 1 << 20);
  ASSERT_THAT(text, IsOk());
  for (const char* key : {R"("stage": "accepted")", R"("camera_mesh": {)", R"("objects": [)"}) {
    EXPECT_THAT(*text, HasSubstr(key));
  }
}

TEST_F(RealFramesTest, RejectsAMalformedFileWithTheFrame) {
  EXPECT_THAT(Recognize(), StatusIs(absl::StatusCode::kNotFound, HasSubstr("frames.json")));
  for (
      const char* json :
      {"{", "{}", "[{}]", R"([{"frame": "f.pcd", "objects": [{"object": "a"}]}])",
       R"([{"frame": "f.pcd", "objects": [{"object": "a", "mesh": "a.ply", "meshUnit": "inch"}]}])",
       R"([{"frame": "f.pcd", "objects": [{"object": "a", "mesh": "a.ply", "meshUnit": "m",
             "T_sensor_mesh": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 2, 0], [0, 0, 0, 1]]}]}])"}) {
    WriteFramesJson(json);
    EXPECT_THAT(Recognize(), StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("frames.json")))
        << json;
  }
}

// As from a BOP file: the object would count as lost, and the right answer as wrong.
TEST_F(RealFramesTest, RejectsAPoseInMillimetres) {
  WriteFrame("l-bracket", Pose(Eigen::Translation3d(0, 0, 800)));
  EXPECT_THAT(Recognize(), StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("millimetres")));
}

TEST_F(RealFramesTest, RejectsAnObjectWithTwoMeshes) {
  const auto json = [](const char* second) {
    return absl::StrFormat(R"([
        {"frame": "a.pcd", "objects": [{"object": "Nut", "mesh": "n.ply", "meshUnit": "m"}]},
        {"frame": "b.pcd", "objects": [{"object": "nut", %s}]}])",
                           second);
  };
  for (const char* second :
       {R"("mesh": "n.stl", "meshUnit": "m")", R"("mesh": "n.ply", "meshUnit": "mm")"}) {
    WriteFramesJson(json(second));
    EXPECT_THAT(LoadFrames(folder_.path()),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("one object one mesh")));
  }
  WriteFramesJson(json(R"("mesh": "./n.ply", "meshUnit": "m")"));
  EXPECT_THAT(LoadFrames(folder_.path()), IsOk());
}

}  // namespace
}  // namespace graspdb::lab
