// What a robot asks in one line of the line protocol (docs/line-protocol.md).
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
  // Before a command: for this line alone. As a command of its own: from now on.
  std::optional<int> format = {};  // a code of pose_format.h
  int job = 0;
  std::optional<recognition::Pose> base_flange = {};
};

// A position farther out than this, in either direction of the wire, is an error.
inline constexpr double kFarthestMm = 100'000;

// To a robot whose line needs a pose format and that never said one.
inline constexpr char kNoFormat[] = "say how poses are written first, such as FORMAT STAUBLI";

// Words are parted by blanks and tabs, capital letters are as small ones. `usual_format` is how
// poses are written where the line does not say: a code, or nothing when the robot never said.
// INVALID_ARGUMENT with a sentence for the robot's programmer; UNIMPLEMENTED when the first word is
// no command.
absl::StatusOr<LineRequest> ParseLineRequest(const std::string& line,
                                             std::optional<int> usual_format);

// The pose format of a vendor's name or of a code from 1 to 51. INVALID_ARGUMENT when it is none.
absl::StatusOr<int> PoseFormatNamed(const std::string& name);

}  // namespace graspdb::client
