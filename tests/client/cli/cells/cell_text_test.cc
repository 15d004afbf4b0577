#include <gmock/gmock.h>

#include "client/cli/cells/commands.h"
#include "files/messages/pose_message.h"
#include "rendering/camera/depth_camera.h"

namespace graspdb::client {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(CellText, NamesTheCommandForAMissingCalibration) {
  v1::Cell cell;
  cell.set_name("cells/press-3");
  EXPECT_THAT(CellText(cell), AllOf(HasSubstr("cells/press-3\n"), HasSubstr("cells level"),
                                    HasSubstr("world's origin"), Not(HasSubstr("workspace"))));
}

TEST(CellText, PrintsPosesRegionsAndSettings) {
  v1::Cell cell;
  cell.set_name("cells/press-3");
  cell.set_display_name("Press 3");
  *cell.mutable_sensor_pose() = files::ToMessage(rendering::LookAt({0, 0, 0}, 0.8, 40, -90));
  cell.mutable_robot_base_pose()->mutable_position()->set_x(-0.6);
  cell.mutable_robot_base_pose()->mutable_orientation()->set_w(1);
  cell.mutable_workspace()->mutable_max()->set_z(0.5);
  cell.mutable_pipeline()->set_min_score(0.7);
  EXPECT_THAT(CellText(cell),
              AllOf(HasSubstr("Press 3"), HasSubstr("looks down by 40.0 degrees"),
                    HasSubstr("at -0.600 0.000 0.000 m"), HasSubstr("to 0.000 0.000 0.500 m"),
                    HasSubstr("min_score: 0.7")));
}

TEST(CellText, TheDisplayNameCannotControlTheTerminal) {
  v1::Cell cell;
  cell.set_name("cells/press-3");
  cell.set_display_name("St\u00e4ubli\x1b[2J");
  EXPECT_THAT(CellText(cell), HasSubstr("cells/press-3, St\u00e4ubli?[2J\n"));
}

TEST(CellText, ACameraOnTheRobotIsReportedOnTheFlange) {
  v1::Cell cell;
  cell.mutable_flange_sensor_pose()->mutable_orientation()->set_w(1);
  EXPECT_THAT(CellText(cell), HasSubstr("on the robot's flange"));
}

}  // namespace
}  // namespace graspdb::client
