// One view of what stands before the camera: taken, taught, and looked at.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <utility>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "client/cell/sensors/depth_sensor.h"
#include "client/sdk/client.h"
#include "client/teaching/turntable/capture_quality.h"
#include "client/teaching/turntable/turntable_coverage.h"
#include "graspdb/v1/cell.pb.h"

namespace graspdb::client {

// How views are taken.
struct ViewTaking {
  v1::Cell cell;                                  // whose camera it is
  std::optional<v1::AxisAlignedBox> region = {};  // that world's; the server's own for none
  // Of what the object stands on above the table z = 0, m. The views are stored in a world whose
  // table is that: for all that is looked at, the same as a camera that is so much lower.
  double plate_height_m = 0;
  int frames = 5;                               // a view is the mean of
  absl::Duration patience = absl::Seconds(10);  // for the frames of a view
};

struct TakenView {
  TurnView view;
  CaptureQuality quality;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  // of the object's points, world frame, m
};

// Takes views. Not thread-safe.
class ViewTaker {
 public:
  // Sensor and client must outlive this.
  ViewTaker(DepthSensor& sensor, Client& client, ViewTaking how)
      : sensor_(sensor), client_(client), how_(std::move(how)) {}

  // Waits for the camera. FAILED_PRECONDITION, with what to do, when nobody knows where it stands;
  // errors of the sensor.
  absl::Status Check();

  // Teaches what is to be seen now as a view of `stable_pose` (a resource name) at `world_object`.
  // FAILED_PRECONDITION when nothing stands there; ALREADY_EXISTS when the very same frame was
  // taught before; errors of the sensor and of the server. Nothing is taught then; where
  // the server does not let go of the view any more, the message names it.
  absl::StatusOr<TakenView> Take(const std::string& stable_pose,
                                 const recognition::Pose& world_object);

 private:
  struct Shot;
  absl::StatusOr<Shot> Shoot(int frames);
  // What the server has kept of the view `name`.
  absl::StatusOr<TakenView> LookAtTaught(const std::string& name, const Shot& shot);

  DepthSensor& sensor_;
  Client& client_;
  const ViewTaking how_;
};

}  // namespace graspdb::client
