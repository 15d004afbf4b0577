// Teaches a grasp by moving the robot to it.
#pragma once

#include <memory>

#include "absl/status/status.h"
#include "client/cell/agent/jobs/cell_frames.h"
#include "client/cell/agent/settings/job_config.h"
#include "client/cell/robots/robot_session.h"
#include "client/sdk/client.h"
#include "graspdb/v1/recognition_service.pb.h"
#include "program/base/monotonic_time.h"

namespace graspdb::client {

// The last recognition result of a robot. A gripper at its grasp hides the object, so the result of
// the robot's previous job is kept until the robot reports an outcome, after which objects lie
// elsewhere.
struct SeenScene : RunnerScene {
  v1::RecognizeResponse answer;
  CellFrames frames;
  MonotonicTime time = MonotonicTime::InfinitePast();
};

// The session's scene; null if there is none since the last outcome, or if it is older than ten
// minutes.
std::shared_ptr<const SeenScene> RecallScene(const RobotSession& session);

// Creates or replaces the grasp of `job` (kShowGrasp) on the object in `scene` nearest to the
// tool centre point `base_tcp` (T_base_tcp); if the job has an object, on that one. The grasp is
// stored as T_object_tcp, relative to the object. NOT_FOUND when no such object is within 0.3 m;
// OUT_OF_RANGE when the tool or the start of its approach is below the table; DATA_LOSS when the
// server rejects the request (see Refusal); UNAVAILABLE and DEADLINE_EXCEEDED. Thread-safe.
absl::Status StoreShownGrasp(Client& client, const JobConfig& job, const SeenScene& scene,
                             const recognition::Pose& base_tcp);

}  // namespace graspdb::client
