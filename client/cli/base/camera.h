// Depth cameras of commands that also call a server.
#pragma once

#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/cell/sensors/depth_sensor.h"

namespace graspdb::client {

// The status of a camera or a robot's agent as the exit status: UNAVAILABLE, which would be
// reported as a missing server, becomes FAILED_PRECONDITION.
absl::Status NotOfServer(const absl::Status& status);

// The same of an error of OpenSensor, whose INVALID_ARGUMENT is wrong usage: the name of no sensor.
absl::Status NotOpened(const absl::Status& status);

// As OpenSensor with its default settings; its errors pass through NotOpened, those of the sensor
// through NotOfServer. Thread-safe as any DepthSensor.
absl::StatusOr<std::unique_ptr<DepthSensor>> OpenCamera(const std::string& spec);

}  // namespace graspdb::client
