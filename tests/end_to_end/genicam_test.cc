// A camera of GigE Vision, read by an agent: Aravis' fake camera shows scenes of taught parts.
#include <gmock/gmock.h>

#include "client/cell/sensors/kinds/open_sensor.h"
#include "tests/client/cell/sensors/genicam/fake_camera.h"
#include "tests/end_to_end/fixtures/cell_fixture.h"
#include "tests/testing/own_network.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::end_to_end {
namespace {

using testing::IsOk;

class GenicamCellTest : public CellProgramsTest {
 protected:
  // Lays out a scene, and lets the camera show it.
  void Show(std::size_t scene) {
    LayOut(scene);
    client::SensorSettings settings;
    settings.max_age = absl::Hours(1);
    const auto renderer =
        client::OpenSensor(absl::StrCat("simulated:scene=", Path(scene_)), settings);
    ASSERT_THAT(renderer, IsOk());
    const auto frame = (*renderer)->Next(MonotonicTime::Now() + absl::Minutes(2));
    ASSERT_THAT(frame, IsOk());
    camera_.Show(std::get<v1::DepthImage>(frame->scan));
  }

  const bool is_in_own_network_ = graspdb::testing::EnterOwnNetwork();  // before the camera starts
  client::FakeGenicamCamera camera_;
};

TEST_F(GenicamCellTest, ARobotGetsGraspsOfWhatTheCameraShows) {
  ASSERT_TRUE(camera_.IsRunning());
  StartCell();
  Show(0);
  StartAgentWith("genicam:Aravis-Fake-GD01?latency=0.1", {"--job", "1 any limit=60s"});
  client::GriClient robot = Robot();
  AwaitCode(client::GriCode::kNoError);
  for (std::size_t scene = 0; scene < 3; ++scene) {
    Show(scene);
    ExpectHolds(Trigger(robot));
  }
}

}  // namespace
}  // namespace graspdb::end_to_end
