// The taught and the missing azimuths of a turn.
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "graspdb/v1/catalog.pb.h"
#include "recognition/base/types.h"

namespace graspdb::client {

// T_world_object of an object that a turntable has turned by `azimuth_deg` (counter-clockwise seen
// from above) about the vertical through `axis` (world frame, m). The object's frame is that of
// the plate: its origin is on the axis, `height_m` above the table. So the views of a turn are in
// one frame wherever the object stands on the plate.
recognition::Pose OnTurntable(const Eigen::Vector2d& axis, double height_m, double azimuth_deg);

// Whether the view's pose is of a turn at `origin` (world frame, m): upright, and within 1 mm.
bool IsOfTurn(const v1::View& view, const Eigen::Vector3d& origin);

// A view of a turn.
struct TurnView {
  std::string name;     // resource name
  int point_count = 0;  // of the object, as stored
};

// The steps of a turn, 0, step, 2 step, … below 360 degrees, and the views taught at them.
class TurntableCoverage {
 public:
  // INVALID_ARGUMENT for a step that is not between 1 and 120 degrees.
  static absl::StatusOr<TurntableCoverage> Create(double step_deg);

  // Counts the views whose poses are of the turn at `origin` (world frame, m), `clockwise` as seen
  // from above. Those between the steps count as others. FAILED_PRECONDITION, with the axis of the
  // view, for a view whose axis is more than 1 mm off, that has another height, or that is tilted.
  absl::Status Add(const std::vector<v1::View>& views, const Eigen::Vector3d& origin,
                   bool clockwise);

  double AzimuthDeg(int step) const { return step * step_deg_; }
  // Replaces the view at the step.
  void Set(int step, const TurnView& view) { taught_[step] = view; }
  // Null if the step is not taught.
  const TurnView* At(int step) const;
  std::vector<int> Missing() const;
  // Mean points of the nearest taught views to both sides, at most 45 degrees away; 0: none.
  double NeighborPoints(int step) const;

  // "[###.#.....]  taught 4 of 11", with the number of views between the steps.
  std::string Ring() const;
  // "60, 100 to 160 degrees"; "" when nothing is missing.
  std::string MissingText() const;

 private:
  TurntableCoverage(double step_deg, int size) : step_deg_(step_deg), size_(size) {}

  double step_deg_;
  int size_;
  int others_ = 0;
  std::map<int, TurnView> taught_;
};

}  // namespace graspdb::client
