#include "client/cell/robots/line/line_request.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/string_view.h"
#include "base/status_macros.h"
#include "client/cell/robots/pose_format.h"

namespace graspdb::client {
namespace {

using recognition::Pose;
using Words = std::span<const absl::string_view>;

constexpr std::size_t kShortPose = 6;  // without a fourth number of the rotation
constexpr std::size_t kLongPose = 7;
constexpr int kLastJob = std::numeric_limits<std::uint16_t>::max();
// Larger angles have another unit, or come from an overflowed counter.
constexpr double kMaxDegrees = 360;
constexpr double kMaxRadians = 6.2832;
constexpr double kMaxQuaternionNumber = 1.01;

struct Command {
  absl::string_view word;
  LineCommand command;
  bool has_job;
  bool may_have_pose;
};

constexpr std::array<Command, 12> kCommands = {{
    {"STATUS", LineCommand::kStatus, false, false},
    {"RUN", LineCommand::kRun, true, true},
    {"START", LineCommand::kStart, true, true},
    {"STATE", LineCommand::kState, true, false},
    {"NEXT", LineCommand::kNext, true, false},
    {"RELATED", LineCommand::kRelated, true, false},
    {"GRASP", LineCommand::kGrasp, true, false},
    {"PICKED", LineCommand::kPicked, false, false},
    {"MISSED", LineCommand::kMissed, false, false},
    {"SLIPPED", LineCommand::kSlipped, false, false},
    {"HELP", LineCommand::kHelp, false, false},
    {"QUIT", LineCommand::kQuit, false, false},
}};

// Formats of the vendors' controllers.
constexpr std::array<std::pair<absl::string_view, int>, 8> kVendors = {{
    {"ABB", kQuaternionWxyz},
    {"UR", kRotationVector},
    {"STAUBLI", 4},
    {"KUKA", 24},
    {"FANUC", 26},
    {"YASKAWA", 26},
    {"MITSUBISHI", 26},
    {"KAWASAKI", 48},
}};

absl::StatusOr<int> JobNamed(absl::string_view word) {
  int job = 0;
  if (absl::SimpleAtoi(word, &job) && job >= 0 && job <= kLastJob) return job;
  return absl::InvalidArgumentError(
      absl::StrCat("a job is a number from 0 to ", kLastJob, ", which '", word, "' is not"));
}

absl::StatusOr<double> NumberWithin(absl::string_view word, double max) {
  double number = 0;
  // No robot sends infinities, NaN or hexadecimal numbers.
  const bool is_plain = word.find_first_not_of("+-.0123456789eE") == absl::string_view::npos;
  if (!is_plain || !absl::SimpleAtod(word, &number)) {
    return absl::InvalidArgumentError(absl::StrCat("'", word, "' is no number"));
  }
  if (!(std::abs(number) <= max)) {
    return absl::InvalidArgumentError(
        absl::StrCat(word, " is beyond ", max, "; are unit and pose format right?"));
  }
  return number;
}

double MaxRotationNumber(int format) {
  switch (RotationUnitOf(format)) {
    case RotationUnit::kQuaternion:
      return kMaxQuaternionNumber;
    case RotationUnit::kRadians:
      return kMaxRadians;
    default:
      return kMaxDegrees;
  }
}

// x y z and three or four numbers of the rotation.
absl::StatusOr<Pose> PoseOf(Words words, std::optional<int> format) {
  if (!format) return absl::InvalidArgumentError(kNoFormat);
  if (words.size() != kShortPose && words.size() != kLongPose) {
    return absl::InvalidArgumentError(
        absl::StrCat("a pose is x y z and 3 or 4 numbers of the rotation, not ", words.size()));
  }
  RobotPose numbers;
  for (std::size_t i = 0; i < words.size(); ++i) {
    ASSIGN_OR_RETURN(const double number,
                     NumberWithin(words[i], i < 3 ? kMaxPositionMm : MaxRotationNumber(*format)));
    (i < 3 ? numbers.position_mm[i] : numbers.rotation[i - 3]) = number;
  }
  const bool uses_all = RotationUnitOf(*format) == RotationUnit::kQuaternion;
  if (!uses_all && numbers.rotation[3] != 0) {
    return absl::InvalidArgumentError(absl::StrCat(
        "pose format ", *format, " has three numbers of the rotation; the fourth is 0"));
  }
  return FromRobotPose(numbers, *format);
}

absl::StatusOr<LineRequest> ParseCommand(Words words, std::optional<int> format) {
  const std::string name = absl::AsciiStrToUpper(words.front());
  const auto* const command = std::ranges::find(kCommands, absl::string_view(name), &Command::word);
  if (command == kCommands.end()) {
    return absl::UnimplementedError(
        absl::StrCat("'", words.front(), "' is not a command; send HELP"));
  }
  LineRequest out = {.command = command->command};
  words = words.subspan(1);
  if (command->has_job) {
    if (words.empty()) return absl::InvalidArgumentError(name + " needs the number of a job");
    ASSIGN_OR_RETURN(out.job, JobNamed(words.front()));
    words = words.subspan(1);
  }
  if (words.empty()) return out;
  if (!command->may_have_pose) {
    return absl::InvalidArgumentError(
        absl::StrCat("nothing is expected after ", name, command->has_job ? " and its job" : ""));
  }
  ASSIGN_OR_RETURN(out.base_flange, PoseOf(words, format));
  return out;
}

}  // namespace

absl::StatusOr<int> PoseFormatNamed(const std::string& name) {
  for (const auto& [vendor, code] : kVendors) {
    if (absl::EqualsIgnoreCase(vendor, name)) return code;
  }
  int code = 0;
  if (absl::SimpleAtoi(name, &code) && code >= kQuaternionWxyz && code <= kLastPoseFormat) {
    return code;
  }
  return absl::InvalidArgumentError(
      absl::StrCat("'", name, "' is no pose format; send a number from 1 to ", kLastPoseFormat,
                   ", or ABB, FANUC, KAWASAKI, KUKA, MITSUBISHI, STAUBLI, UR, YASKAWA"));
}

absl::StatusOr<LineRequest> ParseLineRequest(const std::string& line,
                                             std::optional<int> usual_format) {
  const std::vector<absl::string_view> split =
      absl::StrSplit(line, absl::ByAnyChar(" \t"), absl::SkipEmpty());
  Words words(split);
  if (words.empty()) return absl::InvalidArgumentError("the line is empty; send HELP");
  std::optional<int> format;
  if (absl::EqualsIgnoreCase(words.front(), "FORMAT")) {
    if (words.size() == 1) return absl::InvalidArgumentError("FORMAT needs a name or a number");
    ASSIGN_OR_RETURN(format, PoseFormatNamed(std::string(words[1])));
    words = words.subspan(2);
    if (words.empty()) return LineRequest{.command = LineCommand::kFormat, .format = format};
  }
  absl::StatusOr<LineRequest> out = ParseCommand(words, format ? format : usual_format);
  if (out.ok()) out->format = format;
  return out;
}

}  // namespace graspdb::client
