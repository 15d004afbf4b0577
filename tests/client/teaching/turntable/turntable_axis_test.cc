#include "client/teaching/turntable/turntable_axis.h"

#include <gmock/gmock.h>

#include <numbers>

#include "client/teaching/turntable/turntable_coverage.h"
#include "recognition/points/normals.h"
#include "rendering/sample_parts.h"
#include "rendering/simulation.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using ::graspdb::testing::IsOk;
using ::graspdb::testing::StatusIs;
using recognition::Pose;

Eigen::Vector2d Axis() { return {0.02, -0.04}; }

// A part that stands 12 mm beside the axis, seen every 30 degrees with the camera's noise.
std::vector<TurnedCloud> Turn(const rendering::Workpiece& part, int count) {
  const auto camera = rendering::DepthCamera::Create(rendering::KinectV2());
  EXPECT_THAT(camera, IsOk());
  const Pose world_sensor = rendering::LookAt({Axis().x(), Axis().y(), 0}, 0.8, 40, -90);
  std::vector<TurnedCloud> views;
  for (int i = 0; i < count; ++i) {
    rendering::Scene scene;
    const Pose beside(Eigen::Translation3d(0.010, 0.006, 0));
    scene.objects.push_back(
        {.mesh = &part.mesh, .world_object = OnTurntable(Axis(), 0, 30.0 * i) * beside});
    const auto frame = camera->Render(scene, world_sensor, static_cast<std::uint64_t>(i));
    EXPECT_THAT(frame, IsOk());
    const recognition::Points points =
        rendering::ToPoints(*frame, rendering::KinectV2().intrinsics);
    TurnedCloud view{.azimuth_rad = 30.0 * i * std::numbers::pi / 180, .cloud = {}};
    for (std::size_t pixel = 0; pixel < points.size(); ++pixel) {
      if (frame->surface[pixel] == 0 && points[pixel].allFinite()) {
        view.cloud.points.push_back(points[pixel]);
      }
    }
    view.cloud.normals =
        recognition::EstimateNormals(view.cloud.points, Eigen::Vector3d::Zero(), 0.008);
    const Eigen::Isometry3f sensor = world_sensor.cast<float>();
    for (Eigen::Vector3f& p : view.cloud.points) p = sensor * p;
    for (Eigen::Vector3f& n : view.cloud.normals) n = sensor.linear() * n;
    views.push_back(std::move(view));
  }
  return views;
}

TEST(FindAxis, ItIsFoundWithinHalfAMillimetreFromTwoCentimetresAway) {
  const auto parts = rendering::SampleParts({"flange", "l-bracket"});
  ASSERT_THAT(parts, IsOk());
  ASSERT_EQ(parts->size(), 2U);
  for (const rendering::Workpiece& part : *parts) {
    const auto seen = FindAxis(Turn(part, 12), Axis() + Eigen::Vector2d(0.012, -0.016));
    ASSERT_THAT(seen, IsOk()) << part.object_id;
    EXPECT_LT((seen->axis - Axis()).norm(), 0.0005) << part.object_id;
    EXPECT_GT(seen->share, 0.6);
    EXPECT_LT(seen->rms_m, 0.002);
  }
}

TEST(FindAxis, TwoViewsDoNotDetermineTheAxis) {
  EXPECT_THAT(FindAxis(Turn(rendering::SampleParts().front(), 2), Axis()),
              StatusIs(absl::StatusCode::kFailedPrecondition));
  EXPECT_THAT(FindAxis({}, Axis()), StatusIs(absl::StatusCode::kFailedPrecondition));
}

}  // namespace
}  // namespace graspdb::client
