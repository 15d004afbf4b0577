// Teaching an object with a depth camera and a turntable: a person is led through its stable poses
// and the steps of each turn.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "absl/status/statusor.h"
#include "client/cell/sensors/depth_sensor.h"
#include "client/sdk/client.h"
#include "client/teaching/turntable/teaching_prompt.h"
#include "client/teaching/turntable/turn_dialogue.h"
#include "client/teaching/turntable/view_taking.h"

namespace graspdb::client {

struct GuidedOptions {
  std::string object_id;
  std::string display_name = {};
  // Its `sensor_pose` says where the camera is, or else the frames do; and its region where the
  // turntable is.
  v1::Cell cell = {};
  // Where the turntable's axis meets the table, world frame, m; absent: the middle of the cell's
  // region. At the end of a turn it is computed from the views, see FindAxis. It is not taken from
  // what the camera sees: of an object only the side towards the camera is seen, so that the middle
  // of its points is centimetres before the axis, and its views would not fit together.
  std::optional<Eigen::Vector2d> axis = {};
  double plate_height_m = 0;  // of the turntable above the table z = 0
  double step_deg = 20;       // as the paper's turntable
  bool clockwise = false;     // how it turns, seen from above
  int frames = 5;             // a view is the mean of
  absl::Duration patience = absl::Seconds(10);
};

struct GuidedCounts {
  int taught = 0;        // views
  bool stopped = false;  // before all stable poses were done
};

// Leads through the teaching of one object. Not thread-safe.
//
// Views are at T_world_object = OnTurntable(axis, 0, azimuth), in a world whose table is the plate
// of the turntable. Every one is in the catalogue once its line is told, so whatever ends this, the
// same again goes on with what is missing. Where a move to another axis was broken off, it asks
// first whether the views about that one are to be deleted.
class GuidedTeaching {
 public:
  // All must outlive this.
  GuidedTeaching(DepthSensor& sensor, Client& client, TeachingPrompt& prompt,
                 GuidedOptions options);

  // FAILED_PRECONDITION when nobody knows where camera or axis are; INVALID_ARGUMENT for a step
  // that is not between 1 and 120 degrees or an object id that is none; errors of the sensor before
  // the first view and of the server between views. What goes wrong with a view is told instead.
  absl::StatusOr<GuidedCounts> Run();

 private:
  absl::Status Begin();
  absl::StatusOr<TurntableCoverage> CoverageOf(const std::string& stable_pose_id);
  // Of the stable poses that are there, tells the coverage; the first that misses something, else a
  // new name.
  absl::StatusOr<std::string> ProposeStablePose();
  // The id that the person wants, "" when that was all or nobody answers.
  absl::StatusOr<std::string> AskStablePose();
  // Makes it where it is not there. False when nobody answers.
  absl::StatusOr<bool> MakeStablePose(const std::string& id);
  absl::Status TeachStablePose(const std::string& id);
  // Computes the axis from the views, and asks whether they are to be moved there.
  absl::Status CheckAxis(const std::string& id);
  absl::Status OfferAxis(const std::string& id, const Eigen::Vector2d& axis);
  absl::Status WarnOfLookAlikes();
  void Stop() { counts_.stopped = true; }

  Client& client_;
  TeachingPrompt& prompt_;
  const GuidedOptions options_;
  ViewTaker taker_;
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
  std::set<std::string> visited_;
  GuidedCounts counts_;
};

}  // namespace graspdb::client
