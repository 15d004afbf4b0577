#include <gmock/gmock.h>

#include "client/cli/cells/commands.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using graspdb::testing::IsOk;
using graspdb::testing::StatusIs;
using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(CellUnits, MetresAreAccepted) {
  v1::Cell cell;
  EXPECT_THAT(CheckCellUnits(cell), IsOk());
  cell.mutable_sensor_pose()->mutable_position()->set_z(1.2);
  cell.mutable_robot_base_pose()->mutable_position()->set_x(-15);  // on a track
  cell.mutable_flange_sensor_pose()->mutable_position()->set_y(0.1);
  cell.mutable_region_of_interest()->mutable_max()->set_x(4);
  cell.mutable_workspace()->mutable_min()->set_x(-10);
  EXPECT_THAT(CheckCellUnits(cell), IsOk());
}

TEST(CellUnits, MillimetresAreRefusedWithTheFlag) {
  const auto refuses = [](const v1::Cell& cell, const char* flag) {
    EXPECT_THAT(CheckCellUnits(cell), StatusIs(absl::StatusCode::kInvalidArgument,
                                               AllOf(HasSubstr(flag), HasSubstr("millimetres"))));
  };
  v1::Cell cell;
  cell.mutable_sensor_pose()->mutable_position()->set_z(600);
  refuses(cell, "--sensor-pose");
  cell.Clear();
  cell.mutable_robot_base_pose()->mutable_position()->set_x(-600);
  refuses(cell, "--robot-base-pose");
  cell.Clear();
  cell.mutable_flange_sensor_pose()->mutable_position()->set_y(12);
  refuses(cell, "--flange-sensor-pose");
  cell.Clear();
  cell.mutable_region_of_interest()->mutable_max()->set_x(300);
  refuses(cell, "--region");
  cell.Clear();
  cell.mutable_workspace()->mutable_min()->set_x(-500);
  refuses(cell, "--workspace");
}

}  // namespace
}  // namespace graspdb::client
