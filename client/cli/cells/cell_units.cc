#include "client/cli/cells/cell_units.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "recognition/base/units.h"

namespace graspdb::client {
namespace {

// Cameras, robots, regions and workspaces of a cell are nearer to the table and smaller, m.
constexpr double kFarthestInCellM = 20;
// A camera on the flange is nearer to it, m.
constexpr double kFarthestOnFlangeM = 3;

absl::Status CheckLength(const char* flag, double length_m, double max_m) {
  if (!(length_m > max_m)) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(flag, " reaches ", length_m, " m, and no cell is larger than ", max_m,
                   " m there; lengths are metres, are these millimetres? Then divide them by ",
                   recognition::kMmPerM));
}

double LargestOf(const v1::Vector3& v) {
  return std::max({std::abs(v.x()), std::abs(v.y()), std::abs(v.z())});
}

double LargestOf(const v1::AxisAlignedBox& box) {
  return std::max(LargestOf(box.min()), LargestOf(box.max()));
}

}  // namespace

absl::Status CheckCellUnits(const v1::Cell& cell) {
  absl::Status status =
      CheckLength("--sensor-pose", LargestOf(cell.sensor_pose().position()), kFarthestInCellM);
  status.Update(CheckLength("--robot-base-pose", LargestOf(cell.robot_base_pose().position()),
                            kFarthestInCellM));
  status.Update(CheckLength("--flange-sensor-pose", LargestOf(cell.flange_sensor_pose().position()),
                            kFarthestOnFlangeM));
  status.Update(CheckLength("--region", LargestOf(cell.region_of_interest()), kFarthestInCellM));
  status.Update(CheckLength("--workspace", LargestOf(cell.workspace()), kFarthestInCellM));
  return status;
}

}  // namespace graspdb::client
