#include "client/cell/agent/settings/calibration_config.h"

#include <set>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "base/status_macros.h"
#include "client/sdk/resource_name.h"

namespace graspdb::client {
namespace {

constexpr int kMaxFrames = 100;
// Range of a region's half width, m.
constexpr double kMinHalfWidthM = 0.05;
constexpr double kMaxHalfWidthM = 1;

absl::Status Apply(const std::string& word, HandEyeSetup* setup) {
  const std::pair<std::string, std::string> pair = absl::StrSplit(word, absl::MaxSplits('=', 1));
  const auto& [key, value] = pair;
  if (key == "target" && !value.empty()) {
    setup->target = ResourceName("objects", value);
    return absl::OkStatus();
  }
  if (key == "mount" && (value == "fixed" || value == "flange")) {
    setup->mount = value == "fixed" ? CameraMount::kFixed : CameraMount::kOnFlange;
    return absl::OkStatus();
  }
  if (key == "frames" && absl::SimpleAtoi(value, &setup->frames) && setup->frames >= 1 &&
      setup->frames <= kMaxFrames) {
    return absl::OkStatus();
  }
  double half_width_m = 0;
  if (key == "region" && absl::SimpleAtod(value, &half_width_m) && half_width_m >= kMinHalfWidthM &&
      half_width_m <= kMaxHalfWidthM) {
    setup->region = GrippedRegion(half_width_m);
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError(absl::StrCat(
      "\"", word, "\" is wrong; give target=OBJECT, mount=fixed or mount=flange, frames=1 to ",
      kMaxFrames, ", region=", kMinHalfWidthM, " to ", kMaxHalfWidthM, " (metres)"));
}

absl::Status Parse(const std::string& line, CalibrationConfig* config) {
  const std::vector<std::string> words =
      absl::StrSplit(line, absl::ByAnyChar(" \t"), absl::SkipEmpty());
  if (words.empty() || !absl::SimpleAtoi(words[0], &config->pipeline) || config->pipeline < 0) {
    return absl::InvalidArgumentError("it must start with a pipeline number");
  }
  for (std::size_t i = 1; i < words.size(); ++i) {
    RETURN_IF_ERROR(Apply(words[i], &config->setup));
  }
  if (config->setup.target.empty()) {
    return absl::InvalidArgumentError("target= is missing; give a taught object");
  }
  if (config->setup.region && config->setup.mount == CameraMount::kOnFlange) {
    return absl::InvalidArgumentError(
        "region= is where the gripper holds the target, and is not allowed with mount=flange");
  }
  return absl::OkStatus();
}

constexpr char kCalibrationHelp[] =
    R"(A calibration is a line: its pipeline number, then words.
  0 target=block mount=fixed               the gripper holds the taught object "block"
  0 target=block mount=fixed region=0.3    the same, within 0.3 m of the world's origin in x and y,
                                           6 to 50 cm above the table: faster and more reliable
  1 target=block mount=flange frames=10    the camera is on the robot, the block is on the table)";

}  // namespace

std::string CalibrationHelp() { return kCalibrationHelp; }

absl::StatusOr<std::vector<CalibrationConfig>> ParseCalibrations(
    const std::vector<std::string>& lines, const std::string& cell) {
  std::vector<CalibrationConfig> out;
  std::set<int> taken;
  for (const std::string& line : lines) {
    CalibrationConfig config;
    config.setup.cell = cell;
    absl::Status status = Parse(line, &config);
    if (status.ok() && !taken.insert(config.pipeline).second) {
      status = absl::InvalidArgumentError("its number is taken by another calibration");
    }
    if (!status.ok()) {
      return absl::InvalidArgumentError(
          absl::StrCat("calibration \"", line, "\": ", std::string(status.message())));
    }
    out.push_back(std::move(config));
  }
  return out;
}

}  // namespace graspdb::client
