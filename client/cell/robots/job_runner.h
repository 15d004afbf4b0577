// What robots ask for, whatever protocol they speak.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "recognition/base/types.h"

namespace graspdb::client {

// One object that a robot can do something with: a grasp and the object that it belongs to, or the
// other way round, as the job says.
struct JobPose {
  recognition::Pose base_primary = recognition::Pose::Identity();  // in the robot's base frame
  std::vector<recognition::Pose> base_related = {};
  std::string object = {};       // resource name
  std::string stable_pose = {};  // resource name
  std::string grasp_id = {};     // empty where the stable pose has none
  double score = 0;              // confidence, 0 to 1
  double gripper_opening_m = 0;
  double approach_distance_m = 0;
  double retreat_distance_m = 0;
  double camera_s = 0;  // of the job's time, what went by until the camera had its frame
};

struct JobRequest {
  int job = 0;
  std::string robot;  // who asks, such as its address
  // Where the robot says that its flange is, if that was readable; jobs that show a grasp take it
  // for the tool centre point.
  std::optional<recognition::Pose> base_flange = {};
};

// What became of the pose that a robot was given.
enum class PickOutcome {
  kPicked,   // the object was taken and stayed in the gripper
  kMissed,   // the gripper closed on nothing
  kSlipped,  // the object was taken and lost again
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

  // The poses that the job is set to return, the best first; none where nothing is found. Takes no
  // longer than the job's time limit. Errors as Check, and: INVALID_ARGUMENT when the job needs the
  // robot's pose; ABORTED when the camera gives no frame; UNAVAILABLE when the server is not there;
  // DEADLINE_EXCEEDED; DATA_LOSS when the server refuses.
  virtual absl::StatusOr<std::vector<JobPose>> Run(const JobRequest& request) = 0;

  // Whether Run gives poses; false for jobs that store or report something.
  virtual bool ReturnsPoses(int /*job*/) { return true; }

  // The robot was given this pose: what it tells next is about it.
  virtual void Given(const std::string& robot, const JobPose& pose) = 0;

  // What became of the pose that this robot was given last; only once for each that was given.
  // FAILED_PRECONDITION when it was given none since then; where the outcome cannot be kept, the
  // server's errors as Run has them. A protocol that has no words for outcomes has jobs that tell
  // them: see docs/line-protocol.md.
  virtual absl::Status Tell(const std::string& robot, PickOutcome outcome) = 0;
};

}  // namespace graspdb::client
