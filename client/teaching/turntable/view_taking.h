// Captures a view of the object before the camera, teaches it and computes its quality.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "client/cell/sensors/depth_sensor.h"
#include "client/sdk/client.h"
#include "client/teaching/turntable/turntable_coverage.h"
#include "graspdb/v1/cell.pb.h"
#include "recognition/base/types.h"

namespace graspdb::client {

struct CaptureQuality {
  int point_count = 0;  // of the object
  // The other values exist only for depth images, whose pixels are known.
  bool of_image = false;
  // Share of the pixels between the outermost ones of the object in each row that have a depth:
  // less than 1 where it is black, glossy or transparent.
  double measured_share = 1;
  // Share of the object's pixels whose depth differs by more than 1 % from frame to frame: edges,
  // and most pixels of a moving object.
  double moving_share = 0;
  // Standard deviation of the object's depths from frame to frame, m: the median of its pixels. 0
  // for a single frame.
  double noise_m = 0;
};

// For the object with these points (sensor frame, m) in frames of one stationary camera.
// Errors as ScanOf; INVALID_ARGUMENT without frames.
absl::StatusOr<CaptureQuality> CaptureQualityOf(std::span<const SensorFrame> frames,
                                                const recognition::Points& object);

// "1204 points, 97 % of its outline measured, depths within 1.2 mm".
std::string CaptureQualityText(const CaptureQuality& quality);

// How views are taken.
struct ViewTaking {
  v1::Cell cell = {};                             // whose camera it is
  std::optional<v1::AxisAlignedBox> region = {};  // in that world; none: the server's default
  // Of the plate under the object above the table z = 0, m. The views are stored in a world whose
  // table is the plate: equivalent to a camera that is lower by this height.
  double plate_height_m = 0;
  int frames = 5;                                    // averaged for a view
  absl::Duration frame_timeout = absl::Seconds(10);  // for the frames of a view
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

  // Waits for the camera. FAILED_PRECONDITION, with advice, when its pose is unknown; errors of the
  // sensor.
  absl::Status Check();

  // Teaches the current frames as a view of `stable_pose` (a resource name) at `world_object`.
  // FAILED_PRECONDITION when there is no object; ALREADY_EXISTS when the same frame was taught
  // before; errors of the sensor and of the server. After an error nothing is taught; if the view
  // cannot be deleted again, the message names it.
  absl::StatusOr<TakenView> Take(const std::string& stable_pose,
                                 const recognition::Pose& world_object);

 private:
  struct Shot;
  absl::StatusOr<Shot> Shoot(int frames);
  // The view `name` as the server stored it.
  absl::StatusOr<TakenView> InspectTaught(const std::string& name, const Shot& shot);

  DepthSensor& sensor_;
  Client& client_;
  const ViewTaking how_;
};

}  // namespace graspdb::client
