// What robots ask for, whatever protocol they speak.
#pragma once

#include <optional>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "recognition/types.h"

namespace graspdb::client {

// One thing that a robot can do something with: a grasp and the object that it belongs to, or the
// other way round, as the job says.
struct JobPose {
  recognition::Pose base_primary = recognition::Pose::Identity();  // in the robot's base frame
  std::vector<recognition::Pose> base_related = {};
};

// Does jobs. Implementations are thread-safe.
class JobRunner {
 public:
  virtual ~JobRunner() = default;

  // Whether a job would find its camera and its server.
  virtual bool IsReady() = 0;

  // NOT_FOUND when there is no such job, FAILED_PRECONDITION when what it says cannot be done,
  // PERMISSION_DENIED when it is meant for another protocol.
  virtual absl::Status Check(int job) = 0;

  // The poses that the job is set to return, the best first; none where nothing is found.
  // `base_flange` is where the robot says that it is, if that was readable. Takes no longer than
  // the job's time limit. Errors as Check, and: INVALID_ARGUMENT when the job needs the robot's
  // pose; UNAVAILABLE when server or camera are not there; DEADLINE_EXCEEDED; others when the
  // server refuses.
  virtual absl::StatusOr<std::vector<JobPose>> Run(
      int job, const std::optional<recognition::Pose>& base_flange) = 0;
};

}  // namespace graspdb::client
