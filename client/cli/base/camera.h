// Depth cameras of commands that talk to a server too.
#pragma once

#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/cell/sensors/depth_sensor.h"

namespace graspdb::client {

// What a camera or a robot's agent says, for the end of the program: UNAVAILABLE, which ends it as
// a missing server does, becomes FAILED_PRECONDITION.
absl::Status NotOfServer(const absl::Status& status);

// As OpenSensor with its usual settings; errors of both, the opening and the sensor, are
// NotOfServer. Thread-safe as any DepthSensor.
absl::StatusOr<std::unique_ptr<DepthSensor>> OpenCamera(const std::string& spec);

}  // namespace graspdb::client
