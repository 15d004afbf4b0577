#include "client/calibration/held_region.h"

namespace graspdb::client {
namespace {

// Heights above the table, m.
constexpr double kHeldAboveM = 0.06;
constexpr double kHeldBelowM = 0.5;

}  // namespace

recognition::Box HeldRegion(double half_width_m) {
  return {{-half_width_m, -half_width_m, kHeldAboveM}, {half_width_m, half_width_m, kHeldBelowM}};
}

}  // namespace graspdb::client
