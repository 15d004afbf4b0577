// Converts the server's response to poses that a robot can reach.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "client/cell/agent/jobs/cell_frames.h"
#include "client/cell/agent/settings/job_config.h"
#include "client/cell/robots/job_runner.h"
#include "graspdb/v1/recognition_service.pb.h"
#include "recognition/base/types.h"

namespace graspdb::client {

// What a robot reaches of a grasp: the start of the approach, the grasp and the end of the retreat.
struct Reach {
  // Distance of the tool centre point from the robot's base, metres.
  double min_m = 0;
  double max_m = std::numeric_limits<double>::infinity();
  // World frame.
  std::optional<recognition::Box> workspace = {};
};

// Whether the object of this resource name has the label.
using HasLabel = std::function<bool(const std::string& object, const std::string& label)>;

// The poses of `job` in the robot's base frame: isolated objects before touching ones, then in the
// order of the response. A primary grasp has its object's pose as the related pose. A primary
// object has its grasps as related poses, and is skipped if grasps are taught but none is
// reachable. Grasps out of reach are skipped, and so are objects that are not OK (a primary object
// may be NO_GRASP) or score below the job's minimum.
std::vector<JobPose> PosesFor(const JobConfig& job, const v1::RecognizeResponse& answer,
                              const CellFrames& frames, const Reach& reach,
                              const HasLabel& has_label);

// Why PosesFor returns no pose, for the integrator: a sentence with the RecognitionStatus of the
// response, or with what makes its objects unfit: each reason once, at most three, and the number
// of the others.
std::string NoPoseReason(const JobConfig& job, const v1::RecognizeResponse& answer,
                         const HasLabel& has_label);

}  // namespace graspdb::client
