#include "client/cell/calibration/gripped_region.h"

namespace graspdb::client {
namespace {

// Heights above the table, m.
constexpr double kGrippedAboveM = 0.06;
constexpr double kGrippedBelowM = 0.5;

}  // namespace

recognition::Box GrippedRegion(double half_width_m) {
  return {{-half_width_m, -half_width_m, kGrippedAboveM},
          {half_width_m, half_width_m, kGrippedBelowM}};
}

}  // namespace graspdb::client
