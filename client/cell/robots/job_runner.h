// Jobs and hand-eye calibrations of robots, independent of the protocol.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "graspdb/v1/catalog.pb.h"
#include "recognition/base/types.h"

namespace graspdb::client {

class RobotSession;

// The outcome of a grasp at a pose given to a robot.
enum class PickOutcome {
  kPicked,   // the object was picked and stayed in the gripper
  kMissed,   // the gripper closed on nothing
  kSlipped,  // the object was picked and lost again
};

// A report that may be sent again: under its id it is counted once.
struct PickReport {
  PickOutcome outcome = PickOutcome::kPicked;
  std::string request_id = {};  // a UUID
};

// One result for a robot: a grasp with its object as the related pose, or an object with its
// grasps, depending on the job.
struct JobPose {
  recognition::Pose base_primary = recognition::Pose::Identity();  // in the robot's base frame
  std::vector<recognition::Pose> base_related = {};
  std::vector<v1::Grasp> related_grasps = {};  // those of base_related; empty if it is the object
  std::string object = {};                     // resource name
  std::string stable_pose = {};                // resource name
  // Of an object the first one, until the robot takes another of related_grasps. As taught; without
  // an id there is none.
  v1::Grasp grasp = {};
  double score = 0;                       // confidence, 0 to 1
  double camera_s = 0;                    // part of the job's time spent waiting for the frame
  std::optional<PickReport> report = {};  // the last one, which failed
};

struct JobRequest {
  int job = 0;
  RobotSession& session;  // of the robot; must outlive the run
  // The flange pose that the robot sent, if valid; jobs that show a grasp use it as the pose of the
  // tool centre point.
  std::optional<recognition::Pose> base_flange = {};
  // What is wrong with the pose that the robot sent; empty if it is valid, or none was sent.
  std::string pose_fault = {};
};

// Runs jobs. Implementations are thread-safe.
class JobRunner {
 public:
  virtual ~JobRunner() = default;

  // Whether camera and server are available.
  virtual bool IsReady() = 0;

  // NOT_FOUND when there is no such job, FAILED_PRECONDITION when it is misconfigured,
  // PERMISSION_DENIED when it is for another protocol.
  virtual absl::Status Check(int job) = 0;

  // The job's poses, the best first; empty when nothing is found. Takes no longer than the job's
  // time limit. Errors as Check, and: INVALID_ARGUMENT when the job needs the robot's pose; ABORTED
  // when the camera gives no frame; UNAVAILABLE when the server is unavailable; DEADLINE_EXCEEDED;
  // DATA_LOSS when the server rejects the request.
  virtual absl::StatusOr<std::vector<JobPose>> Run(const JobRequest& request) = 0;

  // Whether Run returns poses; false for jobs that store a grasp or report an outcome.
  virtual bool ReturnsPoses(int /*job*/) { return true; }

  // Reports the outcome of the last pose given to this robot, once per pose. FAILED_PRECONDITION
  // when no pose was given since the last outcome; the server's errors, as in Run, when the outcome
  // cannot be stored. Protocols without a command for outcomes use jobs instead: see
  // docs/line-protocol.md.
  virtual absl::Status ReportOutcome(RobotSession& session, PickOutcome outcome) = 0;
};

// Residuals of a calibration.
struct CalibrationReport {
  double shift_m = 0;  // root mean square over the poses used
  double turn_rad = 0;
  std::size_t used = 0;   // poses that agree with the others
  std::size_t poses = 0;  // number of poses set
};

// Calibrates cameras, each a pipeline with a number. Implementations are thread-safe; the state
// belongs to the pipeline, not to the robot's connection.
//
// Errors of all but Check: FAILED_PRECONDITION when the cell or the target is not set up correctly;
// UNAVAILABLE when the server is unavailable; DATA_LOSS when the camera gives no frame that can be
// used; DEADLINE_EXCEEDED; ABORTED when Init was not called; others for other failures. Error
// messages contain the next step.
class RobotCalibrator {
 public:
  virtual ~RobotCalibrator() = default;

  // NOT_FOUND when there is no such pipeline.
  virtual absl::Status Check(int pipeline) = 0;

  // Starts a new calibration; discards the previous poses.
  virtual absl::Status Init(int pipeline) = 0;

  // Detects the target while the robot stands still at T_base_flange. Replaces the slot, but only
  // if the target is found. NOT_FOUND when it is not.
  virtual absl::Status SetPose(int pipeline, int slot, const recognition::Pose& base_flange) = 0;

  // Solves and saves. NOT_FOUND when the poses are too few, too similar or inconsistent.
  virtual absl::StatusOr<CalibrationReport> Calibrate(int pipeline) = 0;
};

}  // namespace graspdb::client
