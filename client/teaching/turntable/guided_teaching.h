// Teaching an object with a depth camera and a turntable: prompts a person for its stable poses and
// the steps of each turn.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <set>
#include <string>

#include "absl/status/statusor.h"
#include "client/cell/sensors/depth_sensor.h"
#include "client/sdk/client.h"
#include "client/teaching/turntable/turn_dialogue.h"
#include "client/teaching/turntable/view_taking.h"

namespace graspdb::client {

struct GuidedOptions {
  std::string object_id;
  std::string display_name = {};
  // Its `sensor_pose`, or else that of the frames, is the camera's pose; its region contains the
  // turntable.
  v1::Cell cell = {};
  // Where the turntable's axis meets the table, world frame, m; absent: the middle of the cell's
  // region. At the end of a turn it is computed from the views, see FindAxis. The centroid of a
  // first view cannot replace it: the camera sees only the near side of the object, so the centroid
  // is centimetres before the axis, and the views would not fit together.
  std::optional<Eigen::Vector2d> axis = {};
  double plate_height_m = 0;  // of the turntable above the table z = 0
  double step_deg = 20;       // as the paper's turntable
  bool clockwise = false;     // how it turns, seen from above
  int frames = 5;             // averaged for a view
  absl::Duration frame_timeout = absl::Seconds(10);
};

struct GuidedCounts {
  int taught = 0;        // views
  bool stopped = false;  // before all stable poses were done
};

// Guides a person through teaching one object. Not thread-safe.
//
// Views are at T_world_object = OnTurntable(axis, 0, azimuth), in a world whose table is the plate
// of the turntable. Each is in the catalogue once its line is printed; after an interruption, a new
// run continues with the missing ones. If a move to another axis was interrupted, it first offers
// to delete the views about that axis.
class GuidedTeaching {
 public:
  // All must outlive this.
  GuidedTeaching(DepthSensor& sensor, Client& client, TeachingPrompt& prompt,
                 GuidedOptions options);

  // FAILED_PRECONDITION when the pose of the camera or the axis is unknown; INVALID_ARGUMENT for a
  // step that is not between 1 and 120 degrees or an invalid object id; errors of the sensor before
  // the first view and of the server between views. Errors of a view are printed instead.
  absl::StatusOr<GuidedCounts> Run();

 private:
  absl::Status Begin();
  absl::StatusOr<TurntableCoverage> CoverageOf(const std::string& stable_pose_id);
  // Prints the coverage of the existing stable poses and returns the first incomplete one, else a
  // new name.
  absl::StatusOr<std::string> ProposeStablePose();
  // The id that the person enters, "" when done or at the end of the input.
  absl::StatusOr<std::string> PromptForStablePose();
  // Creates it if it does not exist. False at the end of the input.
  absl::StatusOr<bool> MakeStablePose(const std::string& id);
  absl::Status TeachStablePose(const std::string& id);
  // Computes the axis from the views, and offers to move them to it.
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
