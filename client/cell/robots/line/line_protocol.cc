#include "client/cell/robots/line/line_protocol.h"

#include "absl/strings/str_cat.h"
#include "client/cell/robots/line/line_reply.h"

namespace graspdb::client {
namespace {

constexpr char kHelp[] =
    "STATUS, FORMAT name, RUN job [pose], START job [pose], STATE job, NEXT job, RELATED job, "
    "GRASP job, PICKED, MISSED, SLIPPED, HELP, QUIT; FORMAT name may stand before another";

std::string WithoutEnd(std::string_view line) {
  if (line.ends_with('\n')) line.remove_suffix(1);
  if (line.ends_with('\r')) line.remove_suffix(1);
  return std::string(line);
}

std::string ErrorLine(const absl::Status& status) {
  const GriCode code = status.code() == absl::StatusCode::kUnimplemented ? GriCode::kInvalidAction
                                                                         : GriCodeOf(status);
  return client::ErrorLine(code, std::string(status.message()));
}

std::string LineOf(const absl::StatusOr<std::string>& line) {
  return line.ok() ? *line : ErrorLine(line.status());
}

std::string LineOf(const JobAnswer& answer) {
  return answer.code == GriCode::kNoError ? OkLine() : client::ErrorLine(answer.code, answer.why);
}

std::string NameOf(GriJobStatus status) {
  switch (status) {
    case GriJobStatus::kInactive:
      return "INACTIVE";
    case GriJobStatus::kRunning:
      return "RUNNING";
    case GriJobStatus::kDone:
      return "DONE";
    case GriJobStatus::kFailed:
      return "FAILED";
  }
  return "UNKNOWN";
}

std::string PoseLineOf(const JobAnswer& answer, int format) {
  return answer.code == GriCode::kNoError ? LineOf(PoseLine(answer, format)) : LineOf(answer);
}

std::string GivePrimary(RobotSession& session, int job, const JobAnswer& answer, int format) {
  std::string line = PoseLineOf(answer, format);
  if (line.starts_with("OK")) {
    session.SetGiven(answer.primary);
  } else if (answer.code == GriCode::kNoError) {
    session.SkipPrimary(job);
  }
  return line;
}

// An object's grasp is the pose that the next outcome refers to.
std::string GiveRelated(RobotSession& session, const JobAnswer& answer, int format) {
  std::string line = PoseLineOf(answer, format);
  const bool is_given = line.starts_with("OK");
  if (is_given && !answer.primary.related_grasps.empty()) session.SetGiven(answer.primary);
  return line;
}

std::string LastGrasp(RobotSession& session, int job) {
  const std::optional<JobPose> primary = session.LastPrimary(job);
  if (primary) return LineOf(GraspLine(*primary));
  return client::ErrorLine(GriCode::kNoPosesFound, "the job gave no pose yet; send RUN or NEXT");
}

}  // namespace

std::size_t LineProtocol::MessageBytes(std::string_view received) const {
  const std::size_t end = received.find('\n');
  if (end != std::string_view::npos) return end + 1;
  return received.size() < kMaxRequestBytes ? 0 : received.size();
}

RobotReply LineProtocol::Answer(const std::string& robot, std::string_view message) {
  if (message.size() > kMaxRequestBytes || !message.ends_with('\n')) {
    return {.bytes = client::ErrorLine(GriCode::kInvalidRequestLength,
                                       absl::StrCat("a line is of at most ", kMaxRequestBytes,
                                                    " characters, its end included")),
            .hang_up = true};
  }
  const auto session = jobs_.SessionOf(robot);
  if (!session.ok()) return {.bytes = ErrorLine(session.status())};
  const std::optional<int> own_format = (*session)->format();
  const std::optional<int> usual_format = own_format ? own_format : options_.pose_format;
  absl::StatusOr<LineRequest> request = ParseLineRequest(WithoutEnd(message), usual_format);
  if (!request.ok()) return {.bytes = ErrorLine(request.status())};
  if (!request->format) request->format = usual_format;
  return {.bytes = AnswerLine(**session, *request),
          .hang_up = request->command == LineCommand::kQuit};
}

std::string LineProtocol::AnswerLine(RobotSession& session, const LineRequest& request) {
  switch (request.command) {
    case LineCommand::kStatus:
      return OkLine(jobs_.runner().IsReady() ? "1" : "0");
    case LineCommand::kFormat:
      session.SetFormat(*request.format);
      return OkLine(absl::StrCat(*request.format));
    case LineCommand::kPicked:
      return ReportOutcome(session, PickOutcome::kPicked);
    case LineCommand::kMissed:
      return ReportOutcome(session, PickOutcome::kMissed);
    case LineCommand::kSlipped:
      return ReportOutcome(session, PickOutcome::kSlipped);
    case LineCommand::kHelp:
      return OkLine(kHelp);
    case LineCommand::kQuit:
      return OkLine();
    default:
      return AnswerJob(session, request);
  }
}

std::string LineProtocol::AnswerJob(RobotSession& session, const LineRequest& request) {
  const int job = request.job;
  if (const JobAnswer check = jobs_.Check(job); check.code != GriCode::kNoError) {
    return LineOf(check);
  }
  const JobRequest job_request = {
      .job = job, .session = session, .base_flange = request.base_flange};
  if (request.command == LineCommand::kStart) return LineOf(jobs_.Start(job_request));
  if (request.command == LineCommand::kGrasp) return LastGrasp(session, job);
  if (request.command == LineCommand::kState) {
    const GriJobStatus status = session.StatusOf(job);
    return OkLine(absl::StrCat(static_cast<int>(status), " ", NameOf(status)));
  }
  // All others return a pose; without a format none is taken from the job.
  if (!request.format) return client::ErrorLine(GriCode::kInvalidRequest, kNoFormat);
  if (request.command == LineCommand::kRelated) {
    return GiveRelated(session, session.NextRelated(job), *request.format);
  }
  const bool runs = request.command == LineCommand::kRun;
  return GivePrimary(session, job, runs ? jobs_.Run(job_request) : jobs_.Next(session, job),
                     *request.format);
}

std::string LineProtocol::ReportOutcome(RobotSession& session, PickOutcome outcome) {
  const absl::Status status = jobs_.runner().ReportOutcome(session, outcome);
  if (status.ok()) return OkLine();
  // The request is out of order; the job is not misconfigured.
  if (status.code() == absl::StatusCode::kFailedPrecondition) {
    return client::ErrorLine(GriCode::kInvalidRequest, std::string(status.message()));
  }
  return ErrorLine(status);
}

}  // namespace graspdb::client
