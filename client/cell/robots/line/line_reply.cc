#include "client/cell/robots/line/line_reply.h"

#include <algorithm>
#include <cmath>

#include "absl/status/status.h"
#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status_macros.h"
#include "client/cell/robots/line/line_request.h"
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

}  // namespace

std::string OkLine(const std::string& words) {
  return words.empty() ? "OK\n" : absl::StrCat("OK ", words, "\n");
}

std::string ErrorLine(GriCode code, const std::string& why) {
  std::string out = absl::StrCat("ERR ", static_cast<int>(code), " ", GriCodeName(code), ": ", why);
  const auto is_unprintable = [](char c) {
    return !absl::ascii_isprint(static_cast<unsigned char>(c));
  };
  std::ranges::replace_if(out, is_unprintable, ' ');
  if (out.size() >= kMaxReplyBytes) out.resize(kMaxReplyBytes - 1);
  return out + "\n";
}

absl::StatusOr<std::string> PoseLine(const JobAnswer& answer, int format) {
  ASSIGN_OR_RETURN(const RobotPose pose, ToRobotPose(answer.base_pose, format));
  std::string out = absl::StrCat(answer.primaries_left, " ", answer.related_left);
  for (const double mm : pose.position_mm) {
    RETURN_IF_ERROR(AppendMm(mm, &out));
  }
  for (const double number : pose.rotation) {
    if (!std::isfinite(number)) return absl::OutOfRangeError("the rotation is none");
    absl::StrAppend(&out, " ", Fixed(number, DecimalsOfRotation(format)));
  }
  return OkLine(out);
}

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

}  // namespace graspdb::client
