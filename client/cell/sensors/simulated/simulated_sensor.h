// The simulated camera as a sensor.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "client/cell/sensors/depth_sensor.h"
#include "program/base/monotonic_time.h"
#include "rendering/camera/depth_camera.h"
#include "rendering/capture_plan.h"
#include "rendering/workpiece.h"

namespace graspdb::client {

// The next scene: workpieces, the camera's pose and the seed of its noise. Called from one thread
// at a time. Next returns its errors: UNAVAILABLE simulates an unplugged camera.
using SceneSource = std::function<absl::StatusOr<rendering::PlannedCapture>()>;

// A new random scene at every call, the same ones for the same options; `options.count` is ignored.
// `parts` as in PlanRandomScenes.
SceneSource RandomScenes(std::vector<rendering::Workpiece> parts,
                         const rendering::RandomSceneOptions& options);

// Renders a scene as a depth image in whole millimetres at every call, with the camera's pose.
// Thread-safe.
class SimulatedSensor : public DepthSensor {
 public:
  // The scenes show `parts` on a table. Errors as DepthCamera::Create.
  static absl::StatusOr<std::unique_ptr<SimulatedSensor>> Create(
      const rendering::DepthCameraModel& camera, std::vector<rendering::Workpiece> parts,
      SceneSource scenes);

  // The errors of the source and of DepthCamera::Render; INVALID_ARGUMENT when a scene has a
  // workpiece that is not in `parts`; DEADLINE_EXCEEDED when rendering was too slow.
  absl::StatusOr<SensorFrame> Next(MonotonicTime deadline) override ABSL_LOCKS_EXCLUDED(mutex_);
  bool IsReady() override { return true; }
  std::string Name() const override { return "simulated camera"; }

 private:
  SimulatedSensor(rendering::DepthCamera camera, std::vector<rendering::Workpiece> parts,
                  SceneSource scenes);
  absl::StatusOr<rendering::PlannedCapture> Choose() ABSL_LOCKS_EXCLUDED(mutex_);

  const rendering::DepthCamera camera_;
  const std::vector<rendering::Workpiece> parts_;
  absl::Mutex mutex_;
  SceneSource scenes_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace graspdb::client
