// From what the server answered to what a robot is given.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "client/cell/agent/cell_frames.h"
#include "client/cell/agent/job_config.h"
#include "client/cell/agent/reach.h"
#include "client/cell/robots/job_runner.h"
#include "graspdb/v1/recognition_service.pb.h"

namespace graspdb::client {

// Whether the object of that resource name carries a label.
using HasLabel = std::function<bool(const std::string& object, const std::string& label)>;

// The poses of `job`, in the robot's base frame: of objects that stand alone before those that
// touch others, then in the order of the answer. A primary grasp has its object's pose as the
// related one; a primary object its grasps, and is left out where none can be reached unless none
// is taught. Grasps out of reach are left out, and so are objects that are not OK (or, where
// objects are primary, without a grasp), or score lower than the job wants.
std::vector<JobPose> PosesFor(const JobConfig& job, const v1::RecognizeResponse& answer,
                              const CellFrames& frames, const Reach& reach,
                              const HasLabel& has_label);

}  // namespace graspdb::client
