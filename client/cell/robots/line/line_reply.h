// Replies of the line protocol (docs/line-protocol.md).
#pragma once

#include <cstddef>
#include <string>

#include "absl/status/statusor.h"
#include "client/cell/robots/gri_code.h"
#include "client/cell/robots/job_runner.h"
#include "client/cell/robots/robot_session.h"

namespace graspdb::client {

// Maximum length of a reply, its end of line included: controllers have strings of 254 characters.
inline constexpr std::size_t kMaxReplyBytes = 250;

// All replies end in a line feed.
std::string OkLine(const std::string& words = {});

// "ERR <number> <name>: <sentence>". Unprintable characters become blanks; a reply that is too long
// is truncated.
std::string ErrorLine(GriCode code, const std::string& why);

// "OK <primaries left> <related left> x y z r1 r2 r3 r4": millimetres with three decimals, degrees
// with four, radians and quaternions with six. OUT_OF_RANGE when a number is not finite or the
// position is beyond kMaxPositionMm; INVALID_ARGUMENT when there is no such format.
absl::StatusOr<std::string> PoseLine(const JobAnswer& answer, int format);

// "OK <approach> <retreat> <opening> <score> <object> <stable pose> <grasp>": millimetres with
// three decimals, a score with four, names or "-". OUT_OF_RANGE as PoseLine, and when the names are
// too long for a line.
absl::StatusOr<std::string> GraspLine(const JobPose& pose);

}  // namespace graspdb::client
