// Sample parts that are rendered into a frame, which is rendered, too.
#include "lab/experiment/trials/composites.h"

#include <gmock/gmock.h>

#include "rendering/camera/depth_camera.h"
#include "rendering/sample_parts.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::lab {
namespace {

using ::graspdb::testing::IsOk;
using recognition::Pose;
using recognition::Scan;

class CompositesTest : public ::testing::Test {
 protected:
  CompositesTest() {
    for (const char* name : {"l-bracket", "flange", "handle"}) {
      auto parts = rendering::SampleParts({name});
      EXPECT_THAT(parts, IsOk());
      set_.Add(parts->front(), Pose::Identity());
    }
  }

  Scan Background(bool with_table) const {
    rendering::DepthCameraModel model = rendering::KinectV2();
    const auto camera = rendering::DepthCamera::Create(model);
    EXPECT_THAT(camera, IsOk());
    rendering::Scene scene;
    if (with_table) scene.objects = {{&set_.parts[0].mesh, Pose::Identity()}};
    scene.with_table = with_table;
    const auto frame = camera->Render(scene, rendering::LookAt({0, 0, 0}, 0.8, 40, -90), 1);
    EXPECT_THAT(frame, IsOk());
    return {.points = rendering::ToPoints(*frame, model.intrinsics),
            .world_sensor = {},
            .region = recognition::Box{{-0.25, -0.25, -0.05}, {0.25, 0.25, 0.4}},
            .width = frame->width};
  }

  absl::StatusOr<Composite> Make(const Scan& scan, std::uint64_t seed) const {
    RealFrame frame{.name = "frame", .path = {}, .sensor = {}, .arrangement = {}, .objects = {}};
    frame.objects.push_back(
        {.object = "l-bracket", .mesh = {}, .unit_m = 1, .sensor_mesh = Pose::Identity()});
    return Compose(frame, scan, set_, {}, {.objects = 2, .seed = seed});
  }

  // Points of the scan that are within the part's box at its pose, 8 mm larger. Of 200 pixels, half
  // may lie between two surfaces.
  std::size_t CountOn(const Composite& composite, const FrameObject& object) const {
    const auto& part =
        *std::ranges::find(set_.parts, object.object, &rendering::Workpiece::object_id);
    recognition::Box box = rendering::BoundsOf(part.mesh);
    box.min.array() -= 0.008;
    box.max.array() += 0.008;
    const Pose mesh_sensor = object.sensor_mesh->inverse();
    return static_cast<std::size_t>(std::ranges::count_if(
        composite.scan.points,
        [&](const auto& p) { return box.Contains(mesh_sensor * p.template cast<double>()); }));
  }

  PartSet set_;
};

TEST_F(CompositesTest, ShowsThePartsAtTheirTruePoses) {
  const Scan scan = Background(/*with_table=*/true);
  int placed = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto made = Make(scan, seed);
    ASSERT_THAT(made, IsOk());
    ASSERT_EQ(made->scan.points.size(), scan.points.size());
    EXPECT_FALSE(made->frame.objects[0].sensor_mesh.has_value()) << "new ones may hide it";
    for (std::size_t i = 1; i < made->frame.objects.size(); ++i) {
      EXPECT_GT(CountOn(*made, made->frame.objects[i]), 100U) << seed << " " << i;
      ++placed;
    }
  }
  EXPECT_GE(placed, 8);
}

TEST_F(CompositesTest, TheSameSeedGivesTheSameScan) {
  const Scan scan = Background(/*with_table=*/true);
  const auto first = Make(scan, 3);
  const auto second = Make(scan, 3);
  const auto other = Make(scan, 4);
  ASSERT_THAT(first, IsOk());
  ASSERT_THAT(second, IsOk());
  ASSERT_THAT(other, IsOk());
  const auto depths = [](const Composite& composite) {
    std::vector<float> out;
    for (const auto& p : composite.scan.points) out.push_back(p.z() > 0 ? p.z() : 0);
    return out;
  };
  EXPECT_EQ(depths(*first), depths(*second));
  EXPECT_NE(depths(*first), depths(*other));
}

TEST_F(CompositesTest, WithoutATableNothingIsPlaced) {
  EXPECT_FALSE(Make(Background(/*with_table=*/false), 1).ok());
}

}  // namespace
}  // namespace graspdb::lab
