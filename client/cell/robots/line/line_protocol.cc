#include "client/cell/robots/line/line_protocol.h"

#include <algorithm>
#include <cmath>

#include "absl/status/status.h"
#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status_macros.h"
#include "client/cell/robots/pose_format.h"
#include "recognition/base/units.h"

namespace graspdb::client {
namespace {

using recognition::kMmPerM;

constexpr int kMmDecimals = 3;
constexpr int kDegreeDecimals = 4;
constexpr int kRadianDecimals = 6;
constexpr int kScoreDecimals = 4;

int DecimalsOfRotation(int format) {
  return RotationUnitOf(format) == RotationUnit::kDegrees ? kDegreeDecimals : kRadianDecimals;
}

// Never "-0.000".
std::string Fixed(double number, int decimals) {
  std::string out = absl::StrFormat("%.*f", decimals, number);
  if (out.starts_with('-') && out.find_first_not_of("-0.") == std::string::npos) out.erase(0, 1);
  return out;
}

absl::Status AppendMm(double mm, std::string* line) {
  if (!(std::abs(mm) <= kMaxPositionMm)) {
    return absl::OutOfRangeError(absl::StrCat(mm, " mm is farther out than ", kMaxPositionMm,
                                              "; is the cell's calibration right?"));
  }
  absl::StrAppend(line, " ", Fixed(mm, kMmDecimals));
  return absl::OkStatus();
}

std::string NameOr(const std::string& name) { return name.empty() ? "-" : name; }

// All replies end in a line feed.
std::string OkLine(const std::string& words = "") {
  return words.empty() ? "OK\n" : absl::StrCat("OK ", words, "\n");
}

// "ERR <number> <name>: <sentence>". Unprintable characters become blanks; a reply that is too long
// is truncated.
std::string ErrorLine(GriCode code, const std::string& why) {
  std::string out = absl::StrCat("ERR ", static_cast<int>(code), " ", GriCodeName(code), ": ", why);
  const auto is_unprintable = [](char c) {
    return !absl::ascii_isprint(static_cast<unsigned char>(c));
  };
  std::ranges::replace_if(out, is_unprintable, ' ');
  if (out.size() >= kMaxReplyBytes) out.resize(kMaxReplyBytes - 1);
  return out + "\n";
}

std::string ErrorLine(const absl::Status& status) {
  const GriCode code = status.code() == absl::StatusCode::kUnimplemented ? GriCode::kInvalidAction
                                                                         : GriCodeOf(status);
  return ErrorLine(code, std::string(status.message()));
}

// "OK <primaries left> <related left> x y z r1 r2 r3 r4": millimetres with three decimals, degrees
// with four, radians and quaternions with six. OUT_OF_RANGE when a number is not finite or the
// position is beyond kMaxPositionMm; INVALID_ARGUMENT when there is no such format.
absl::StatusOr<std::string> PoseLine(const JobAnswer& answer, int format) {
  ASSIGN_OR_RETURN(const RobotPose pose, ToRobotPose(answer.base_pose, format));
  std::string out = absl::StrCat(answer.primaries_left, " ", answer.related_left);
  for (const double mm : pose.position_mm) {
    RETURN_IF_ERROR(AppendMm(mm, &out));
  }
  for (const double number : pose.rotation) {
    if (!std::isfinite(number))
      return absl::OutOfRangeError("the rotation has a number that is not finite");
    absl::StrAppend(&out, " ", Fixed(number, DecimalsOfRotation(format)));
  }
  return OkLine(out);
}

// "OK <approach> <retreat> <opening> <score> <object> <stable pose> <grasp>": millimetres with
// three decimals, a score with four, names or "-". OUT_OF_RANGE as PoseLine, and when the names are
// too long for a line.
absl::StatusOr<std::string> GraspLine(const JobPose& pose) {
  std::string numbers;
  const v1::Grasp& grasp = pose.grasp;
  for (const double m :
       {grasp.approach_distance_m(), grasp.retreat_distance_m(), grasp.gripper_opening_m()}) {
    RETURN_IF_ERROR(AppendMm(m * kMmPerM, &numbers));
  }
  if (!std::isfinite(pose.score)) return absl::OutOfRangeError("the score is no number");
  const std::string out = OkLine(absl::StrCat(
      numbers.substr(1), " ", Fixed(pose.score, kScoreDecimals), " ", NameOr(pose.object), " ",
      NameOr(pose.stable_pose), " ", NameOr(grasp.grasp_id())));
  if (out.size() <= kMaxReplyBytes) return out;
  return absl::OutOfRangeError(
      "the names of object and grasp are too long for a line; shorten them");
}

constexpr char kHelp[] =
    "STATUS, FORMAT name, RUN job [pose], START job [pose], STATE job, NEXT job, RELATED job, "
    "GRASP job, PICKED, MISSED, SLIPPED, HELP, QUIT; FORMAT name may stand before another";

std::string WithoutEnd(std::string_view line) {
  if (line.ends_with('\n')) line.remove_suffix(1);
  if (line.ends_with('\r')) line.remove_suffix(1);
  return std::string(line);
}

std::string LineOf(const absl::StatusOr<std::string>& line) {
  return line.ok() ? *line : ErrorLine(line.status());
}

std::string LineOf(const JobAnswer& answer) {
  return answer.code == GriCode::kNoError ? OkLine() : ErrorLine(answer.code, answer.why);
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
  return ErrorLine(GriCode::kNoPosesFound, "the job gave no pose yet; send RUN or NEXT");
}

}  // namespace

std::size_t LineProtocol::MessageBytes(std::string_view received) const {
  const std::size_t end = received.find('\n');
  if (end != std::string_view::npos) return end + 1;
  return received.size() < kMaxRequestBytes ? 0 : received.size();
}

RobotReply LineProtocol::Answer(const std::string& robot, std::string_view message) {
  if (message.size() > kMaxRequestBytes || !message.ends_with('\n')) {
    return {.bytes = ErrorLine(GriCode::kInvalidRequestLength,
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
  if (!request.format) return ErrorLine(GriCode::kInvalidRequest, kNoFormat);
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
    return ErrorLine(GriCode::kInvalidRequest, std::string(status.message()));
  }
  return ErrorLine(status);
}

}  // namespace graspdb::client
