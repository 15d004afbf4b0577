#include "client/cell/robots/gri/gri_protocol.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "program/log/log_field.h"

namespace graspdb::client {
namespace {

using recognition::Pose;

constexpr double kMillionthsOfMmPerM = 1e9;
constexpr double kMillionthsOfDegreePerRadian = 1e6 * 180 / std::numbers::pi;

GriCode CodeOfAction(GriAction action) {
  switch (action) {
    case GriAction::kHecInit:
      return GriCode::kHecInitError;
    case GriAction::kHecSetPose:
      return GriCode::kHecSetPoseError;
    default:
      return GriCode::kHecCalibrateError;
  }
}

// The code for an error of a RobotCalibrator; the action's own code where none is more specific.
GriCode HecCodeOf(const absl::Status& status, GriAction action) {
  switch (status.code()) {
    case absl::StatusCode::kOk:
      return GriCode::kNoError;
    case absl::StatusCode::kNotFound:
      return GriCode::kHecInsufficientDetection;
    case absl::StatusCode::kFailedPrecondition:
      return GriCode::kHecConfigError;
    case absl::StatusCode::kInvalidArgument:
      return GriCode::kInvalidRequest;
    case absl::StatusCode::kUnavailable:
      return GriCode::kApiNotReachable;
    case absl::StatusCode::kDataLoss:
      return GriCode::kPipelineNotAvailable;
    case absl::StatusCode::kDeadlineExceeded:
      return GriCode::kProcessingTimeout;
    default:
      return CodeOfAction(action);
  }
}

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

constexpr std::string_view kGriPrefix("GRI\0", 4);
constexpr std::size_t kVersionAt = 4;
constexpr std::size_t kLengthAt = 5;

bool MayBeGri(std::string_view received) {
  const std::size_t known = std::min(received.size(), kGriPrefix.size());
  return received.substr(0, known) == kGriPrefix.substr(0, known);
}

bool HasRequestLength(std::string_view received) {
  return static_cast<std::uint8_t>(received[kLengthAt]) == kGriRequestBytes;
}

RobotReply Encode(const GriResponse& response, bool hang_up) {
  const auto bytes = GriBytes(response);
  return {.bytes = std::string(bytes.begin(), bytes.end()), .hang_up = hang_up};
}

std::string WrongVersion(int version) {
  return absl::StrCat("the message is of version ", version, "; send ", int{kGriVersion});
}

std::string WrongLength(int length) {
  return absl::StrCat("the message gives ", length, " as its length; send ", kGriRequestBytes);
}

// What is wrong with the header of a request.
std::string ReasonOf(GriCode fault, const GriRequest& request) {
  switch (fault) {
    case GriCode::kUnknownProtocolVersion:
      return WrongVersion(request.version);
    case GriCode::kInvalidRequest:
      return absl::StrCat("there is no pose format ", int{request.pose_format}, "; send ",
                          kQuaternionWxyz, " to ", kLastPoseFormat);
    case GriCode::kInvalidAction:
      return absl::StrCat("there is no action ", int{request.action}, "; send 1 to 9");
    default:
      return WrongLength(request.length);
  }
}

// A robot gets the number only, so that the log has the reason.
void LogInvalid(const std::string& robot, GriCode code, const std::string& reason) {
  spdlog::warn("event=request_refused robot={} code={} error={}", LogField(robot),
               GriCodeName(code), LogField(reason));
}

// The answer to an incomplete or invalid header.
RobotReply Refuse(const std::string& robot, std::string_view message) {
  GriResponse out;
  if (!MayBeGri(message) || message.size() < kGriHeaderBytes) {
    out.code = GriCode::kInvalidRequest;
    LogInvalid(robot, out.code, "the message does not begin with \"GRI\" and a zero byte");
    return Encode(out, /*hang_up=*/true);
  }
  out.pose_format = static_cast<std::uint8_t>(message[kLengthAt + 1]);
  out.action = static_cast<std::uint8_t>(message[kLengthAt + 2]);
  // The length field may have another meaning in other versions.
  const auto version = static_cast<std::uint8_t>(message[kVersionAt]);
  const bool is_known = version == kGriVersion;
  out.code = is_known ? GriCode::kInvalidRequestLength : GriCode::kUnknownProtocolVersion;
  LogInvalid(robot, out.code,
             is_known ? WrongLength(static_cast<std::uint8_t>(message[kLengthAt]))
                      : WrongVersion(version));
  return Encode(out, /*hang_up=*/true);
}

}  // namespace

absl::Status GriHandEye::Do(const GriRequest& request, GriResponse* out) {
  const int pipeline = request.data[0];
  const auto action = static_cast<GriAction>(request.action);
  if (action == GriAction::kHecInit) return calibrator_->Init(pipeline);
  if (action == GriAction::kHecSetPose) {
    const int slot = request.data[1];
    if (slot < 0 || slot > kLastHecSlot) {
      return absl::InvalidArgumentError(
          absl::StrCat("there is no slot ", slot, "; slots are 0 to ", kLastHecSlot));
    }
    ASSIGN_OR_RETURN(const auto base_flange, RobotPoseOf(request));
    return calibrator_->SetPose(pipeline, slot, base_flange);
  }
  ASSIGN_OR_RETURN(const CalibrationReport report, calibrator_->Calibrate(pipeline));
  out->data[gri_data::kShift] = Saturated(report.shift_m * kMillionthsOfMmPerM);
  out->data[gri_data::kTurn] = Saturated(report.turn_rad * kMillionthsOfDegreePerRadian);
  out->data[gri_data::kUsed] = static_cast<std::int32_t>(report.used);
  return absl::OkStatus();
}

absl::Status GriHandEye::DoAlone(const GriRequest& request, GriResponse* out) {
  std::mutex* turn = nullptr;
  {
    const absl::MutexLock lock(&mutex_);
    turn = &turns_[request.data[0]];  // stays where it is
  }
  const std::unique_lock alone(*turn, std::try_to_lock);
  if (alone) return Do(request, out);
  return absl::AbortedError("the pipeline's last request is still being answered; wait for it");
}

GriResponse GriHandEye::Answer(const GriRequest& request) {
  GriResponse out = ResponseTo(request);
  const int pipeline = request.data[0];
  if (calibrator_ == nullptr || !calibrator_->Check(pipeline).ok()) {
    spdlog::warn("event=no_calibration_pipeline pipeline={}", pipeline);
    out.code = GriCode::kPipelineNotAvailable;
    return out;
  }
  const absl::Status status = DoAlone(request, &out);
  out.code = HecCodeOf(status, static_cast<GriAction>(request.action));
  if (!status.ok()) {
    spdlog::warn("event=calibration_failed pipeline={} code={} error={}", pipeline,
                 static_cast<int>(out.code), LogField(std::string(status.message())));
  }
  return out;
}

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

std::size_t GriProtocol::MessageBytes(std::string_view received) const {
  if (!MayBeGri(received)) return received.size();
  if (received.size() < kGriHeaderBytes) return 0;
  if (!HasRequestLength(received)) return kGriHeaderBytes;
  return received.size() < kGriRequestBytes ? 0 : kGriRequestBytes;
}

GriResponse GriProtocol::Dispatch(const std::string& robot, const GriRequest& request) {
  switch (static_cast<GriAction>(request.action)) {
    case GriAction::kHecInit:
    case GriAction::kHecSetPose:
    case GriAction::kHecCalibrate:
      return hand_eye_.Answer(request);
    default:
      return jobs_.Answer(robot, request);
  }
}

RobotReply GriProtocol::Answer(const std::string& robot, std::string_view message) {
  if (message.size() != kGriRequestBytes) return Refuse(robot, message);
  std::array<std::uint8_t, kGriRequestBytes> bytes = {};
  std::ranges::copy(message, bytes.begin());
  const absl::StatusOr<GriRequest> request = ParseGriRequest(bytes);
  if (!request.ok()) return Refuse(robot, message);
  const GriCode fault = CheckGriRequest(*request);
  if (fault == GriCode::kNoError) return Encode(Dispatch(robot, *request), /*hang_up=*/false);
  LogInvalid(robot, fault, ReasonOf(fault, *request));
  GriResponse out = ResponseTo(*request);
  out.code = fault;
  return Encode(out, /*hang_up=*/false);
}

}  // namespace graspdb::client
