#include "rendering/simulation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "files/capture_sets/capture_set.h"
#include "files/messages/pose_message.h"
#include "files/points/point_file.h"
#include "rendering/meshes/mesh_file.h"
#include "rendering/sample_parts.h"
#include "tests/files/temporary_folder.h"
#include "tests/rendering/mesh_measure.h"

namespace graspdb::rendering {
namespace {

using ::testing::HasSubstr;

// Few pixels, so that the tests are quick.
SimulationOptions Small(double noise) {
  SimulationOptions options;
  options.camera.intrinsics = {
      .width = 172, .height = 142, .fx = 122, .fy = 122, .cx = 85.5, .cy = 70.5};
  options.camera.noise.scale = noise;
  return options;
}

std::vector<Workpiece> SomeParts() {
  std::vector<Workpiece> parts = SampleParts();
  return {parts[0], parts[4], parts[12]};
}

std::vector<PlannedCapture> QuarterTurns() {
  TurntableOptions options;
  options.azimuth_step_deg = 90;
  return *PlanTurntable(SomeParts(), options);
}

std::vector<PlannedCapture> Scenes(int count, int objects) {
  RandomSceneOptions options;
  options.count = count;
  options.objects_per_scene = objects;
  return *PlanRandomScenes(SomeParts(), options);
}

// Share of a capture's points farther than `tolerance_m` from both the table and the mesh at its
// pose in the set, and the number of points on the object.
struct Agreement {
  double astray = 0;
  int on_object = 0;
};

Agreement Compare(const std::filesystem::path& folder, const v1::CaptureSet& set,
                  const v1::Capture& capture, float tolerance_m) {
  const auto file = files::ReadPointFile(folder / capture.path());
  EXPECT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->width * file->height, 172 * 142);
  const recognition::Pose sensor = files::FromMessage(capture.sensor_pose());
  EXPECT_TRUE(file->sensor_pose && file->sensor_pose->isApprox(sensor, 1e-5)) << capture.path();
  const auto object = std::find_if(
      set.objects().begin(), set.objects().end(),
      [&](const v1::CapturedObject& o) { return o.object_id() == capture.object_id(); });
  const auto mesh = LoadMesh(folder / object->mesh_path());
  const recognition::Pose from_sensor =
      files::FromMessage(capture.object_pose()).inverse() * sensor;
  Agreement agreement;
  int total = 0;
  for (const Eigen::Vector3f& p : file->points) {
    if (!p.allFinite()) continue;
    ++total;
    const Eigen::Vector3f q = (from_sensor * p.cast<double>()).cast<float>();
    const bool on_table = std::abs(q.z()) < tolerance_m;
    const bool on_mesh = !on_table && DistanceTo(*mesh, q, tolerance_m) < tolerance_m;
    agreement.on_object += on_mesh ? 1 : 0;
    agreement.astray += on_table || on_mesh ? 0 : 1;
  }
  agreement.astray /= std::max(total, 1);
  return agreement;
}

TEST(Simulation, TurntableSetLoadsWithMeshesInTheClouds) {
  const files::TemporaryFolder folder;
  ASSERT_TRUE(WriteSimulation(folder.path(), SomeParts(), QuarterTurns(), Small(0)).ok());
  const auto set = files::LoadCaptureSet(folder.path());
  ASSERT_TRUE(set.ok()) << set.status();
  EXPECT_EQ(set->objects_size(), 3);
  EXPECT_EQ(set->objects(2).stable_poses(0).symmetry_order(), 2);
  EXPECT_GE(set->objects(0).stable_poses(0).grasps_size(), 1);
  EXPECT_EQ(set->region_of_interest().max().z(), 0.40);
  ASSERT_EQ(files::CapturesOf(*set, v1::Capture::TEACH).size(), 12U);
  for (const v1::Capture& capture : set->captures()) {
    const Agreement agreement = Compare(folder.path(), *set, capture, 0.0002F);
    EXPECT_EQ(agreement.astray, 0) << capture.path();
    EXPECT_GT(agreement.on_object, 60) << capture.path();
    EXPECT_FALSE(capture.segmented());
  }
}

TEST(Simulation, RandomScenesAgreeWithinTheNoise) {
  const files::TemporaryFolder folder;
  ASSERT_TRUE(WriteSimulation(folder.path(), SomeParts(), Scenes(6, 1), Small(1)).ok());
  const auto set = files::LoadCaptureSet(folder.path());
  ASSERT_TRUE(set.ok()) << set.status();
  ASSERT_EQ(files::CapturesOf(*set, v1::Capture::QUERY).size(), 6U);
  for (const v1::Capture& capture : set->captures()) {
    const Agreement agreement = Compare(folder.path(), *set, capture, 0.006F);
    EXPECT_LT(agreement.astray, 0.01) << capture.path();
    EXPECT_GT(agreement.on_object, 40) << capture.path();
  }
}

TEST(Simulation, SegmentedCapturesContainOnlyTheNamedObject) {
  const files::TemporaryFolder folder;
  SimulationOptions options = Small(0);
  options.segmented = true;
  ASSERT_TRUE(WriteSimulation(folder.path(), SomeParts(), Scenes(3, 2), options).ok());
  const auto set = files::LoadCaptureSet(folder.path());
  for (const v1::Capture& capture : set->captures()) {
    EXPECT_TRUE(capture.segmented());
    const auto file = files::ReadPointFile(folder.path() / capture.path());
    const auto measured = std::count_if(file->points.begin(), file->points.end(),
                                        [](const Eigen::Vector3f& p) { return p.allFinite(); });
    const Agreement agreement = Compare(folder.path(), *set, capture, 0.0002F);
    EXPECT_EQ(agreement.astray, 0);
    EXPECT_GT(measured, 20);
    EXPECT_LT(measured, 1000);
  }
}

TEST(Simulation, IsDeterministic) {
  const files::TemporaryFolder folder;
  for (const char* run : {"a", "b"}) {
    ASSERT_TRUE(WriteSimulation(folder.path() / run, SomeParts(), Scenes(3, 2), Small(1)).ok());
  }
  int files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path() / "a")) {
    if (!entry.is_regular_file()) continue;
    const auto relative = std::filesystem::relative(entry.path(), folder.path() / "a");
    EXPECT_EQ(files::BytesOf(entry.path()), files::BytesOf(folder.path() / "b" / relative))
        << relative;
    ++files;
  }
  EXPECT_EQ(files, 3 + 3 + 1);
}

TEST(Simulation, InterruptedRunLeavesNoSetAndReportsItsProgress) {
  const files::TemporaryFolder folder;
  std::vector<int> reported;
  SimulationWatch watch;
  watch.report = [&reported](int done, int total) {
    EXPECT_EQ(total, 12);
    reported.push_back(done);
  };
  watch.cancelled = [&reported] { return reported.size() == 3; };
  const absl::Status stopped =
      WriteSimulation(folder.path(), SomeParts(), QuarterTurns(), Small(1), watch);
  EXPECT_EQ(stopped.code(), absl::StatusCode::kCancelled);
  EXPECT_THAT(std::string(stopped.message()), HasSubstr("3 of 12"));
  EXPECT_THAT(reported, ::testing::ElementsAre(1, 2, 3));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "captures.json"));
}

TEST(Simulation, ReplacesASetOnlyWithOverwrite) {
  const files::TemporaryFolder folder;
  SimulationOptions options = Small(1);
  ASSERT_TRUE(WriteSimulation(folder.path(), SomeParts(), Scenes(2, 1), options).ok());
  const absl::Status again = WriteSimulation(folder.path(), SomeParts(), Scenes(3, 1), options);
  EXPECT_EQ(again.code(), absl::StatusCode::kAlreadyExists);
  EXPECT_NE(again.message().find("--overwrite"), absl::string_view::npos) << again;
  EXPECT_EQ(files::LoadCaptureSet(folder.path())->captures_size(), 2);
  options.overwrite = true;
  EXPECT_TRUE(WriteSimulation(folder.path(), SomeParts(), Scenes(3, 1), options).ok());
  EXPECT_EQ(files::LoadCaptureSet(folder.path())->captures_size(), 3);
}

TEST(Simulation, RejectsACameraWithoutAVisibleObject) {
  const files::TemporaryFolder folder;
  TurntableOptions near;
  near.stand.distances_m = {0.3};
  const absl::Status blind =
      WriteSimulation(folder.path(), SomeParts(), *PlanTurntable(SomeParts(), near), Small(1));
  EXPECT_EQ(blind.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(blind.message()), HasSubstr("choose another distance"));
  std::vector<PlannedCapture> plan = QuarterTurns();
  plan[1].placements[0].part = 3;
  EXPECT_EQ(WriteSimulation(folder.path(), SomeParts(), plan, Small(1)).code(),
            absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(WriteSimulation(folder.path(), SomeParts(), {}, Small(1)).code(),
            absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace graspdb::rendering
