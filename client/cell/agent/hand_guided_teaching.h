// Teaches a grasp by moving the robot to it.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "client/cell/agent/cell_frames.h"
#include "client/cell/agent/job_config.h"
#include "client/sdk/client.h"
#include "graspdb/v1/recognition_service.pb.h"

namespace graspdb::client {

// The last recognition result of a robot.
struct SeenScene {
  v1::RecognizeResponse answer;
  CellFrames frames;
  absl::Time time;
};

// Stores the tool pose as a grasp of the object at the tool. A gripper at its grasp hides the
// object, so the result of the robot's previous job is kept; it is valid until the object moves.
// Thread-safe.
class HandGuidedTeaching {
 public:
  // `client` must outlive this. Scenes older than `memory` are ignored.
  HandGuidedTeaching(Client& client, absl::Duration memory) : client_(client), memory_(memory) {}

  void Remember(const std::string& robot, SeenScene scene);
  // The robot's last scene, unless it is too old.
  std::optional<SeenScene> Recall(const std::string& robot);

  // Creates or replaces the grasp of `job` (kShowGrasp) on the object in `scene` nearest to the
  // tool centre point `base_tcp` (T_base_tcp); if the job has an object, on that one. The grasp is
  // stored as T_object_tcp, relative to the object. NOT_FOUND when no such object is within 0.3 m;
  // OUT_OF_RANGE when the tool or the start of its approach is below the table; DATA_LOSS when the
  // server rejects the request (see Refusal); UNAVAILABLE and DEADLINE_EXCEEDED.
  absl::Status Store(const JobConfig& job, const SeenScene& scene,
                     const recognition::Pose& base_tcp);

 private:
  Client& client_;
  const absl::Duration memory_;
  absl::Mutex mutex_;
  std::map<std::string, SeenScene> seen_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace graspdb::client
