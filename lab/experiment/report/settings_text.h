// What a case did, in words.
#pragma once

#include <string>

#include "lab/experiment/experiment.h"

namespace graspdb::lab {

// "Kinect v1", "Kinect v2" or "other camera", by the intrinsics.
std::string CameraName(const rendering::DepthCameraModel& camera);

// Sentences about the taught views and the queries.
std::string SettingsText(const CaseResult& result);

}  // namespace graspdb::lab
