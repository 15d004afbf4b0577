#include "client/cell/robots/line_protocol.h"

#include "absl/strings/str_cat.h"
#include "client/cell/robots/line_reply.h"

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
  const absl::StatusOr<LineRequest> request =
      ParseLineRequest(WithoutEnd(message), FormatOf(robot));
  if (!request.ok()) return {.bytes = ErrorLine(request.status())};
  return {.bytes = AnswerLine(robot, *request), .hang_up = request->command == LineCommand::kQuit};
}

std::string LineProtocol::AnswerLine(const std::string& robot, const LineRequest& request) {
  switch (request.command) {
    case LineCommand::kStatus:
      return OkLine(jobs_.runner().IsReady() ? "1" : "0");
    case LineCommand::kFormat:
      return KeepFormat(robot, *request.format);
    case LineCommand::kPicked:
      return ReportOutcome(robot, PickOutcome::kPicked);
    case LineCommand::kMissed:
      return ReportOutcome(robot, PickOutcome::kMissed);
    case LineCommand::kSlipped:
      return ReportOutcome(robot, PickOutcome::kSlipped);
    case LineCommand::kHelp:
      return OkLine(kHelp);
    case LineCommand::kQuit:
      return OkLine();
    default:
      return AnswerJob(robot, request);
  }
}

std::string LineProtocol::AnswerJob(const std::string& robot, const LineRequest& request) {
  const int job = request.job;
  if (const JobAnswer check = jobs_.Check(job); check.code != GriCode::kNoError) {
    return LineOf(check);
  }
  const JobRequest job_request = {.job = job, .robot = robot, .base_flange = request.base_flange};
  if (request.command == LineCommand::kStart) return LineOf(jobs_.Start(job_request));
  if (request.command == LineCommand::kGrasp) return AnswerGrasp(robot, job);
  if (request.command == LineCommand::kState) {
    const GriJobStatus status = jobs_.StatusOf(robot, job);
    return OkLine(absl::StrCat(static_cast<int>(status), " ", NameOf(status)));
  }
  // All others return a pose; without a format none is taken from the job.
  const std::optional<int> format = request.format ? request.format : FormatOf(robot);
  if (!format) {
    return client::ErrorLine(GriCode::kInvalidRequest, kNoFormat);
  }
  if (request.command == LineCommand::kRelated) {
    return PoseLineOf(jobs_.NextRelated(robot, job), *format);
  }
  const bool runs = request.command == LineCommand::kRun;
  return GivePrimary(robot, job, runs ? jobs_.Run(job_request) : jobs_.Next(robot, job), *format);
}

std::string LineProtocol::GivePrimary(const std::string& robot, int job, const JobAnswer& answer,
                                      int format) {
  std::string line = PoseLineOf(answer, format);
  if (line.starts_with("OK")) {
    jobs_.runner().Given(robot, answer.primary);
  } else if (answer.code == GriCode::kNoError) {
    jobs_.SkipPrimary(robot, job);
  }
  return line;
}

std::string LineProtocol::AnswerGrasp(const std::string& robot, int job) {
  const std::optional<JobPose> primary = jobs_.LastPrimary(robot, job);
  if (!primary) {
    return client::ErrorLine(GriCode::kNoPosesFound, "the job gave no pose yet; send RUN or NEXT");
  }
  return LineOf(GraspLine(*primary));
}

std::string LineProtocol::ReportOutcome(const std::string& robot, PickOutcome outcome) {
  const absl::Status status = jobs_.runner().ReportOutcome(robot, outcome);
  if (status.ok()) return OkLine();
  // The request is out of order; the job is not misconfigured.
  if (status.code() == absl::StatusCode::kFailedPrecondition) {
    return client::ErrorLine(GriCode::kInvalidRequest, std::string(status.message()));
  }
  return ErrorLine(status);
}

std::optional<int> LineProtocol::FormatOf(const std::string& robot) {
  absl::MutexLock lock(&mutex_);
  const auto found = formats_.find(robot);
  return found == formats_.end() ? options_.pose_format : std::optional(found->second);
}

std::string LineProtocol::KeepFormat(const std::string& robot, int format) {
  absl::MutexLock lock(&mutex_);
  formats_[robot] = format;
  return OkLine(absl::StrCat(format));
}

}  // namespace graspdb::client
