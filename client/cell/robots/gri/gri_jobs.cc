#include "client/cell/robots/gri/gri_jobs.h"

#include <spdlog/spdlog.h>

#include "program/log/log_field.h"

namespace graspdb::client {
namespace {

using recognition::Pose;

std::int32_t CountOf(std::size_t count) { return static_cast<std::int32_t>(count); }

std::int32_t Millionths(double value) { return Saturated(1e6 * value); }

void DescribeGrasp(const JobPose& primary, GriResponse* response) {
  const v1::Grasp& grasp = primary.grasp;
  response->data[gri_data::kGripperOpening] = Millionths(1e3 * grasp.gripper_opening_m());
  response->data[gri_data::kApproachDistance] = Millionths(1e3 * grasp.approach_distance_m());
  response->data[gri_data::kRetreatDistance] = Millionths(1e3 * grasp.retreat_distance_m());
  response->data[gri_data::kScore] = Millionths(primary.score);
  response->data[gri_data::kCameraTime] = Millionths(primary.camera_s);
}

JobRequest JobRequestOf(const GriRequest& request, RobotSession& session) {
  JobRequest out = {.job = request.job_id, .session = session};
  if (!HasRobotPose(request)) return out;
  const absl::StatusOr<Pose> pose = RobotPoseOf(request);
  if (pose.ok()) {
    out.base_flange = *pose;
  } else {
    out.pose_fault = std::string(pose.status().message());
  }
  return out;
}

// A robot gets the number only, so that the log has the reason.
void LogRefusal(const std::string& robot, int job, const JobAnswer& check) {
  spdlog::warn("event=request_refused robot={} job={} code={} error={}", LogField(robot), job,
               GriCodeName(check.code), LogField(check.why));
}

// Writes the pose of an answer, or its error code.
void Give(const JobAnswer& answer, GriResponse* response) {
  response->code = answer.code;
  if (answer.code != GriCode::kNoError) return;
  response->data[gri_data::kPrimaryLeft] = CountOf(answer.primaries_left);
  response->data[gri_data::kRelatedLeft] = CountOf(answer.related_left);
  DescribeGrasp(answer.primary, response);
  const absl::StatusOr<GriPose> sent = ToGriPose(answer.base_pose, response->pose_format);
  if (!sent.ok()) {
    response->code = GriCodeOf(sent.status());
    return;
  }
  response->pose = *sent;
}

void GivePrimary(RobotSession& session, const JobAnswer& answer, GriResponse* response) {
  Give(answer, response);
  if (response->code == GriCode::kNoError) {
    session.SetGiven(answer.primary);
  } else if (answer.code == GriCode::kNoError) {
    session.SkipPrimary(response->job_id);
  }
}

// An object's grasp is the pose that the next outcome refers to.
void GiveRelated(RobotSession& session, const JobAnswer& answer, GriResponse* response) {
  Give(answer, response);
  const bool is_given = response->code == GriCode::kNoError;
  if (is_given && !answer.primary.related_grasps.empty()) session.SetGiven(answer.primary);
}

}  // namespace

void GriJobs::AnswerJob(const std::string& robot, const GriRequest& request,
                        GriResponse* response) {
  const int job = request.job_id;
  const JobAnswer check = jobs_.Check(job);
  response->code = check.code;
  if (check.code != GriCode::kNoError) return LogRefusal(robot, job, check);
  const auto kept = jobs_.SessionOf(robot);
  if (!kept.ok()) {
    response->code = GriCodeOf(kept.status());
    return;
  }
  RobotSession& session = **kept;
  const JobRequest job_request = JobRequestOf(request, session);
  switch (static_cast<GriAction>(request.action)) {
    case GriAction::kTriggerJobSync:
      return GivePrimary(session, jobs_.Run(job_request), response);
    case GriAction::kTriggerJobAsync:
      response->code = jobs_.Start(job_request).code;
      return;
    case GriAction::kGetJobStatus:
      response->data[gri_data::kJobStatus] = static_cast<std::int32_t>(session.StatusOf(job));
      return;
    case GriAction::kGetNextPose:
      return GivePrimary(session, jobs_.Next(session, job), response);
    case GriAction::kGetRelatedPose:
      return GiveRelated(session, session.NextRelated(job), response);
    default:
      response->code = GriCode::kInvalidAction;
  }
}

GriResponse GriJobs::Answer(const std::string& robot, const GriRequest& request) {
  GriResponse out = ResponseTo(request);
  if (static_cast<GriAction>(request.action) == GriAction::kStatus) {
    out.data[gri_data::kReady] = jobs_.runner().IsReady() ? 1 : 0;
  } else {
    AnswerJob(robot, request, &out);
  }
  return out;
}

}  // namespace graspdb::client
