// Teaching a grasp by driving the robot to it.
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

// Where objects stood when a robot last asked.
struct SeenScene {
  v1::RecognizeResponse answer;
  CellFrames frames;
  absl::Time time;
};

// Stores where the tool is as a grasp of the object that it is at. A hand at its grasp hides the
// object; what the robot's job before saw is therefore remembered, and is valid as long as the
// object has not moved since. Thread-safe.
class HandGuidedTeaching {
 public:
  // `client` must outlive this. What was seen longer ago than `memory` is forgotten.
  HandGuidedTeaching(Client& client, absl::Duration memory) : client_(client), memory_(memory) {}

  void Remember(const std::string& robot, SeenScene scene);
  // What that robot saw last, unless it is forgotten.
  std::optional<SeenScene> Recall(const std::string& robot);

  // Makes or replaces the grasp that `job` (kShowGrasp) names, of the object in `scene` that is
  // nearest to the tool centre point `base_tcp` (T_base_tcp), and of the object that the job names,
  // if it names one. Its T_object_tcp follows every pose in which the object will be seen.
  // NOT_FOUND when no such object is within 0.3 m; OUT_OF_RANGE when the tool or the beginning of
  // its approach is below the table; DATA_LOSS when the server refuses (see Refusal); UNAVAILABLE
  // and DEADLINE_EXCEEDED.
  absl::Status Store(const JobConfig& job, const SeenScene& scene,
                     const recognition::Pose& base_tcp);

 private:
  Client& client_;
  const absl::Duration memory_;
  absl::Mutex mutex_;
  std::map<std::string, SeenScene> seen_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace graspdb::client
