#include "lab/datasets/bigbird_object.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "files/point_file.h"
#include "lab/datasets/bigbird_calibration.h"
#include "recognition/points/point_search.h"
#include "rendering/mesh.h"
#include "rendering/sample_parts.h"
#include "tests/files/temporary_folder.h"
#include "tests/lab/datasets/bigbird_folder.h"
#include "tests/lab/datasets/hdf5_writer.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using ::graspdb::testing::IsOk;
using ::graspdb::testing::StatusIs;
using recognition::Pose;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr auto kInvalidArgument = absl::StatusCode::kInvalidArgument;

// One part, seen by two cameras after every 90 degrees.
class BigBirdObjectTest : public ::testing::Test {
 protected:
  void Write(bool with_clouds, bool upside_down) {
    ASSERT_THAT(WriteBigBird(folder_.path(), {part_},
                             {.step_deg = 90,
                              .cameras = {"NP1", "NP4"},
                              .with_clouds = with_clouds,
                              .with_meshes = true,
                              .upside_down = upside_down}),
                IsOk());
  }

  absl::StatusOr<BigBirdObject> Load() const { return LoadBigBirdObject(path_, {"NP1", "NP4"}); }

  // The largest distance from the part as it stands on the table of what the views show of it.
  double FarthestFromThePart(const BigBirdObject& object) const {
    const recognition::PointSearch surface(SampleSurface(part_.mesh, 50'000, /*seed=*/1));
    double farthest = 0;
    for (const BigBirdView& view : object.views) {
      const Pose table_sensor = view.world_table.inverse() * view.world_sensor;
      const recognition::Points points = view.lens ? ReadDepthMap(view.path, *view.lens).value()
                                                   : ReadPointFile(view.path).value().points;
      int seen = 0;
      for (const Eigen::Vector3f& p : points) {
        const Eigen::Vector3d on_table = table_sensor * p.cast<double>();
        if (!p.allFinite() || on_table.z() < 0.003) continue;
        const Eigen::Vector3d on_part = TablePart().inverse() * on_table;
        const auto nearest = surface.Nearest(on_part.cast<float>());
        farthest = std::max(farthest, std::sqrt(static_cast<double>(nearest.squared_distance)));
        ++seen;
      }
      EXPECT_GT(seen, 300) << view.path;
    }
    return farthest;
  }

  const TemporaryFolder folder_;
  const Workpiece part_ = SampleParts().front();
  const std::filesystem::path path_ = folder_.path() / part_.object_id;
};

struct Kind {
  const char* name;
  bool with_clouds;
  bool upside_down;
};

class BigBirdFramesTest : public BigBirdObjectTest, public ::testing::WithParamInterface<Kind> {};

TEST_P(BigBirdFramesTest, PointsLieWhereTheObjectStands) {
  ASSERT_NO_FATAL_FAILURE(Write(GetParam().with_clouds, GetParam().upside_down));
  const auto object = Load();
  ASSERT_THAT(object, IsOk());
  EXPECT_EQ(object->id, part_.object_id);
  ASSERT_EQ(object->views.size(), 8U);
  EXPECT_LT(FarthestFromThePart(*object), 0.0015);
}

TEST_P(BigBirdFramesTest, CamerasStandStillAboveATableThatTurns) {
  ASSERT_NO_FATAL_FAILURE(Write(GetParam().with_clouds, GetParam().upside_down));
  const auto object = Load();
  ASSERT_THAT(object, IsOk());
  for (std::size_t i = 0; i < object->views.size(); ++i) {
    const BigBirdView& view = object->views[i];
    EXPECT_EQ(view.camera, i < 4 ? "NP1" : "NP4");
    EXPECT_EQ(view.turn_deg, 90 * (static_cast<int>(i) % 4));
    EXPECT_GT(view.world_sensor.translation().z(), 0.1);
    EXPECT_TRUE(view.world_sensor.isApprox(object->views[i - i % 4].world_sensor, 1e-6));
    const Pose turned(
        Eigen::AngleAxisd(view.turn_deg * std::numbers::pi / 180, Eigen::Vector3d::UnitZ()));
    EXPECT_TRUE(view.world_table.isApprox(turned, 1e-6)) << view.turn_deg;
  }
}

INSTANTIATE_TEST_SUITE_P(All, BigBirdFramesTest,
                         ::testing::Values(Kind{"Clouds", true, false},
                                           Kind{"CloudsUpsideDown", true, true},
                                           Kind{"DepthMaps", false, false},
                                           Kind{"DepthMapsUpsideDown", false, true}),
                         [](const auto& tested) { return std::string(tested.param.name); });

TEST_F(BigBirdObjectTest, WhatIsLeftOutIsJustNotThere) {
  ASSERT_NO_FATAL_FAILURE(Write(true, false));
  std::filesystem::remove(path_ / "clouds" / "NP1_0.pcd");
  std::filesystem::remove(path_ / "clouds" / "NP4_90.pcd");
  folder_.Write(part_.object_id + "/clouds/NP1_merged.pcd", "of another kind");
  const auto object = Load();
  ASSERT_THAT(object, IsOk());
  ASSERT_EQ(object->views.size(), 6U);
  EXPECT_EQ(object->views[0].turn_deg, 90);
  EXPECT_THAT(LoadBigBirdObject(path_, {"NP2"}),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("NP2; choose other")));
}

TEST_F(BigBirdObjectTest, TheFolderMayBeNamedInAnyWay) {
  ASSERT_NO_FATAL_FAILURE(Write(true, false));
  for (const auto& path : {path_ / "", path_ / ".", path_ / "poses" / ".."}) {
    const auto object = LoadBigBirdObject(path, {"NP1"});
    ASSERT_THAT(object, IsOk());
    EXPECT_EQ(object->id, part_.object_id) << path;
  }
}

TEST_F(BigBirdObjectTest, APoseThatIsMissingIsNamed) {
  ASSERT_NO_FATAL_FAILURE(Write(true, false));
  std::filesystem::remove(path_ / "poses" / "NP5_180_pose.h5");
  EXPECT_THAT(Load(), StatusIs(absl::StatusCode::kNotFound, HasSubstr("NP5_180_pose.h5")));
}

TEST_F(BigBirdObjectTest, APoseThatIsNoneIsRefused) {
  ASSERT_NO_FATAL_FAILURE(Write(true, false));
  const auto pose = path_ / "poses" / "NP5_90_pose.h5";
  const std::string name = "H_table_from_reference_camera";
  const Eigen::Matrix4d mirror = Eigen::Vector4d(1, 1, -1, 1).asDiagonal();
  for (const Eigen::Matrix4d& wrong : {Eigen::Matrix4d(2 * Eigen::Matrix4d::Identity()), mirror}) {
    Hdf5Writer(pose).Add(name, wrong);
    EXPECT_THAT(Load(), StatusIs(kInvalidArgument, AllOf(HasSubstr("NP5_90_pose.h5"),
                                                         HasSubstr("no rigid transform"))));
  }
  Hdf5Writer(pose).Add(name, Eigen::Matrix3d::Identity());
  EXPECT_THAT(Load(), StatusIs(kInvalidArgument, HasSubstr("it must be 4 x 4")));
  folder_.Write(part_.object_id + "/poses/NP5_90_pose.h5", "not HDF5");
  EXPECT_THAT(Load(), StatusIs(kInvalidArgument, HasSubstr("is no HDF5 file")));
}

TEST_F(BigBirdObjectTest, ACameraThatIsNotCalibratedIsNamed) {
  ASSERT_NO_FATAL_FAILURE(Write(true, false));
  Hdf5Writer(path_ / "calibration.h5").Add("H_NP1_from_NP5", Eigen::Matrix4d::Identity());
  EXPECT_THAT(Load(), StatusIs(absl::StatusCode::kNotFound,
                               HasSubstr("calibration.h5: H_NP4_from_NP5 is not there")));
}

// A depth image is calibrated as such where it can be, or else as the infrared image it is made of.
TEST_F(BigBirdObjectTest, TheLensOfTheDepthImageGoesFirst) {
  const Eigen::Matrix3d k = Eigen::Vector3d(500, 500, 1).asDiagonal();
  const Eigen::MatrixXd d = Eigen::MatrixXd::Constant(1, 5, 0.01);
  const auto path = path_ / "calibration.h5";
  const Eigen::MatrixXd one = Eigen::MatrixXd::Ones(1, 1);
  Hdf5Writer(path).Add("NP1_ir_K", k).Add("NP1_ir_d", d).Add("NP1_ir_depth_scale", one);
  auto lens = ReadLens(path_, "NP1");
  ASSERT_THAT(lens, IsOk());
  EXPECT_EQ(lens->fx, 500);
  EXPECT_EQ(lens->distortion[4], 0.01);
  EXPECT_EQ(lens->step_m, 1e-4);
  Hdf5Writer(path)
      .Add("NP1_ir_K", k)
      .Add("NP1_depth_K", 2 * k)
      .Add("NP1_depth_d", d)
      .Add("NP1_ir_depth_scale", one);
  lens = ReadLens(path_, "NP1");
  ASSERT_THAT(lens, IsOk());
  EXPECT_EQ(lens->fx, 1000);
  Hdf5Writer(path).Add("NP1_ir_K", 0 * k).Add("NP1_ir_d", d).Add("NP1_ir_depth_scale", one);
  EXPECT_THAT(ReadLens(path_, "NP1"), StatusIs(kInvalidArgument, HasSubstr("not positive")));
}

}  // namespace
}  // namespace graspdb::client
