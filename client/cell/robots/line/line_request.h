// Requests of the line protocol (docs/line-protocol.md).
#pragma once

#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "recognition/base/types.h"

namespace graspdb::client {

enum class LineCommand {
  kStatus,
  kFormat,
  kRun,
  kStart,
  kState,
  kNext,
  kRelated,
  kGrasp,
  kPicked,
  kMissed,
  kSlipped,
  kHelp,
  kQuit,
};

struct LineRequest {
  LineCommand command = LineCommand::kStatus;
  // Before a command: for this line only. As a command of its own: from now on.
  std::optional<int> format = {};  // a code of pose_format.h
  int job = 0;
  std::optional<recognition::Pose> base_flange = {};
};

// Maximum of a position in requests and replies; larger ones are errors.
inline constexpr double kMaxPositionMm = 100'000;

// Reply to a request that needs a pose format, from a robot that never set one.
inline constexpr char kNoFormat[] = "send the pose format first, such as FORMAT STAUBLI";

// Words are separated by blanks and tabs, and not case-sensitive. `usual_format` is the pose format
// of lines without FORMAT: a code, or nullopt when the robot never set one. INVALID_ARGUMENT with a
// sentence for the robot's programmer; UNIMPLEMENTED for an unknown command.
absl::StatusOr<LineRequest> ParseLineRequest(const std::string& line,
                                             std::optional<int> usual_format);

// The pose format of a vendor's name or of a code from 1 to 51. INVALID_ARGUMENT for others.
absl::StatusOr<int> PoseFormatNamed(const std::string& name);

}  // namespace graspdb::client
