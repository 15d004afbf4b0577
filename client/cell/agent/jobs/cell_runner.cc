#include "client/cell/agent/jobs/cell_runner.h"

#include <google/protobuf/util/time_util.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "base/status_macros.h"
#include "client/cell/agent/jobs/cell_metrics.h"
#include "client/cell/agent/jobs/hand_guided_teaching.h"
#include "client/cell/robots/robot_session.h"
#include "program/base/uuid.h"
#include "program/log/log_field.h"
#include "program/version.h"

namespace graspdb::client {
namespace {

PickOutcome OutcomeOf(JobKind kind) {
  if (kind == JobKind::kPicked) return PickOutcome::kPicked;
  return kind == JobKind::kMissed ? PickOutcome::kMissed : PickOutcome::kSlipped;
}

v1::GraspOutcome OutcomeMessage(PickOutcome outcome) {
  if (outcome == PickOutcome::kPicked) return v1::GRASP_OUTCOME_PICKED;
  return outcome == PickOutcome::kMissed ? v1::GRASP_OUTCOME_MISSED : v1::GRASP_OUTCOME_SLIPPED;
}

void Log(const JobReport& report) {
  const absl::Status& status = report.status;
  const std::string& id = report.capture.request_id;
  spdlog::log(status.ok() ? spdlog::level::info : spdlog::level::warn,
              "event=job job={} robot={} code={} poses={} camera_ms={:.2f} ms={:.2f}{}{}{}",
              report.request.job, LogField(report.request.session.robot()),
              absl::StatusCodeToString(status.code()), report.poses.size(),
              absl::ToDoubleMilliseconds(report.capture.camera_time),
              absl::ToDoubleMilliseconds(report.duration),
              id.empty() ? "" : absl::StrCat(" request_id=", id),
              report.no_pose_reason.empty()
                  ? ""
                  : absl::StrCat(" reason=", LogField(report.no_pose_reason)),
              status.ok() ? "" : absl::StrCat(" error=", LogField(std::string(status.message()))));
}

// The end of an error about a missing pose, if an invalid one was sent.
std::string WrongPose(const JobRequest& request) {
  if (request.pose_fault.empty()) return "";
  return absl::StrCat("; the one that was sent is invalid: ", request.pose_fault);
}

std::shared_ptr<const SeenScene> SceneOf(const CaptureResult& capture, MonotonicTime time) {
  auto out = std::make_shared<SeenScene>();
  out->answer = capture.response;
  out->frames = capture.cell.frames;
  out->time = time;
  return out;
}

}  // namespace

CellRunner::CellRunner(Jobs jobs, JobProtocol protocol, CellRunnerOptions options, CellParts parts)
    : jobs_(std::move(jobs)),
      protocol_(protocol),
      options_(std::move(options)),
      parts_(std::move(parts)),
      labels_(parts_.client) {}

bool CellRunner::IsReady() { return parts_.cell.state().ok() && parts_.sensor.IsReady(); }

absl::Status CellRunner::Check(int job) {
  const auto found = jobs_.find(job);
  if (found == jobs_.end()) {
    return absl::NotFoundError(absl::StrCat("there is no job ", job, " in the cell's settings"));
  }
  const JobProtocol meant = found->second.protocol;
  if (meant != JobProtocol::kAny && meant != protocol_) {
    return absl::PermissionDeniedError(absl::StrCat("job ", job, " is for another protocol"));
  }
  return absl::OkStatus();
}

bool CellRunner::ReturnsPoses(int job) {
  const auto found = jobs_.find(job);
  return found == jobs_.end() || found->second.kind == JobKind::kRecognize;
}

MonotonicTime CellRunner::DeadlineOf(const JobConfig& job) const {
  return MonotonicTime::Now() + job.time_limit.value_or(options_.time_limit);
}

absl::StatusOr<std::vector<JobPose>> CellRunner::Run(const JobRequest& request) {
  RETURN_IF_ERROR(Check(request.job));
  const JobConfig& job = jobs_.at(request.job);
  if (job.kind == JobKind::kRecognize) return Recognize(job, request);
  absl::Status done = job.kind == JobKind::kShowGrasp
                          ? Show(job, request)
                          : ReportOutcome(request.session, OutcomeOf(job.kind));
  Log({.request = request, .start = absl::Now(), .status = done});
  if (!done.ok()) return done;
  return std::vector<JobPose>();
}

absl::StatusOr<std::vector<JobPose>> CellRunner::Recognize(const JobConfig& job,
                                                           const JobRequest& request) {
  JobReport report{request, absl::Now()};
  const MonotonicTime start = MonotonicTime::Now();
  report.status =
      parts_.capture_and_recognize.Run(request.base_flange, DeadlineOf(job), &report.capture);
  if (report.status.ok()) {
    request.session.SetScene(SceneOf(report.capture, start));
    report.status = FindPoses(job, &report);
    request.session.SetNoPoseReason(job.id, report.no_pose_reason);
  } else if (absl::IsInvalidArgument(report.status)) {  // the camera on the robot needs its pose
    report.status =
        absl::InvalidArgumentError(absl::StrCat(report.status.message(), WrongPose(request)));
  }
  report.duration = MonotonicTime::Now() - start;
  parts_.counters.CountJob(report.status, report.poses.size(),
                           report.duration - report.capture.camera_time);
  if (parts_.metrics != nullptr) parts_.metrics->CountJob(report);
  Log(report);
  if (parts_.on_job) parts_.on_job(report);
  if (!report.status.ok()) return report.status;
  return std::move(report.poses);
}

absl::Status CellRunner::FindPoses(const JobConfig& job, JobReport* report) {
  const CaptureResult& capture = report->capture;
  std::shared_ptr<const LabelledObjects> labelled;
  if (!job.label.empty()) {
    absl::StatusOr<std::shared_ptr<const LabelledObjects>> found =
        labels_.At(capture.response.catalog_id(), capture.response.catalog_revision());
    if (!found.ok()) return Refusal(found.status());
    labelled = *std::move(found);
  }
  const auto has_label = [&](const std::string& object, const std::string& label) {
    return labelled->contains({object, label});
  };
  Reach reach = options_.reach;
  reach.workspace = capture.cell.workspace;
  report->poses = PosesFor(job, capture.response, capture.cell.frames, reach, has_label);
  for (JobPose& pose : report->poses) pose.camera_s = absl::ToDoubleSeconds(capture.camera_time);
  if (report->poses.empty()) {
    report->no_pose_reason = NoPoseReason(job, capture.response, has_label);
  }
  return absl::OkStatus();
}

absl::Status CellRunner::Show(const JobConfig& job, const JobRequest& request) {
  if (!request.base_flange) {
    return absl::InvalidArgumentError(
        absl::StrCat("send the pose of the tool with the request", WrongPose(request)));
  }
  std::shared_ptr<const SeenScene> scene = RecallScene(request.session);
  if (scene == nullptr) {
    const MonotonicTime deadline = DeadlineOf(job);
    const absl::StatusOr<KeptCell> cell = parts_.cell.Get(deadline);
    if (cell.ok() && cell->frames.flange_sensor) {
      return absl::InvalidArgumentError(
          "the camera is on the robot, and this request has the pose of the tool, not the flange; "
          "run a recognising job first");
    }
    CaptureResult capture;
    RETURN_IF_ERROR(parts_.capture_and_recognize.Run(request.base_flange, deadline, &capture));
    scene = SceneOf(capture, MonotonicTime::Now());
  }
  absl::Status stored = StoreShownGrasp(parts_.client, job, *scene, *request.base_flange);
  // The tool pose of the request is wrong, not the job.
  const bool is_misplaced = absl::IsNotFound(stored) || absl::IsOutOfRange(stored);
  return is_misplaced ? absl::InvalidArgumentError(stored.message()) : stored;
}

absl::Status CellRunner::ReportOutcome(RobotSession& session, PickOutcome outcome) {
  std::optional<JobPose> pose = session.TakeGiven();
  if (!pose) {
    return absl::FailedPreconditionError("no pose was given to this robot since its last outcome");
  }
  session.SetScene(nullptr);  // the object lies elsewhere: no grasp may be shown relative to it
  if (pose->grasp.grasp_id().empty()) {
    return absl::FailedPreconditionError("the pose that was given has no grasp");
  }
  v1::ReportGraspOutcomeRequest report;
  report.set_name(pose->stable_pose);
  report.set_grasp_id(pose->grasp.grasp_id());
  report.set_outcome(OutcomeMessage(outcome));
  report.set_cell(parts_.name);
  if (!pose->report || pose->report->outcome != outcome) pose->report = {outcome, MakeUuid4()};
  report.set_request_id(pose->report->request_id);
  if (absl::Status kept = parts_.client.ReportGraspOutcome(report).status(); !kept.ok()) {
    session.RestoreGiven(*std::move(pose));  // the report may be retried
    return Refusal(kept);
  }
  parts_.counters.CountOutcome(outcome);
  if (parts_.metrics != nullptr) parts_.metrics->CountPick(pose->object, report.outcome());
  return absl::OkStatus();
}

std::optional<v1::Bundle> BundleOf(const JobReport& report, const std::string& server_version) {
  const v1::RecognizeRequest& request = report.capture.request;
  if (!request.has_depth_image() && !request.has_cloud()) return std::nullopt;
  v1::Bundle out;
  *out.mutable_request_time() =
      google::protobuf::util::TimeUtil::NanosecondsToTimestamp(absl::ToUnixNanos(report.start));
  out.set_duration_ms(absl::ToDoubleMilliseconds(report.duration));
  out.set_robot(report.request.session.robot());
  out.set_job(report.request.job);
  out.set_agent_version(kVersion);
  out.set_server_version(server_version);
  out.set_request_id(report.capture.request_id);
  *out.mutable_request() = request;
  out.set_catalog_revision(report.capture.catalog_revision);
  const absl::Status& answered = report.capture.answered;
  if (answered.ok()) {
    *out.mutable_response() = report.capture.response;
  } else {
    out.mutable_error()->set_code(static_cast<int>(answered.code()));
    out.mutable_error()->set_message(std::string(answered.message()));
  }
  return out;
}

}  // namespace graspdb::client
