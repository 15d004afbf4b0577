// The line protocol (docs/line-protocol.md) for RobotServer: for hand-written robot programs, one
// line of ASCII per request and one per reply.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "client/cell/robots/gri_code.h"
#include "client/cell/robots/job_runner.h"
#include "client/cell/robots/line/line_request.h"
#include "client/cell/robots/robot_server.h"
#include "client/cell/robots/robot_session.h"

namespace graspdb::client {

// Maximum length of a reply, its end of line included: controllers have strings of 254 characters.
inline constexpr std::size_t kMaxReplyBytes = 250;

// Maximum length of a request, its end of line included.
inline constexpr std::size_t kMaxRequestBytes = 256;

struct LineProtocolOptions {
  // Default format, a code of pose_format.h. Without one, robots must send FORMAT: a pose in
  // another vendor's convention looks valid until the arm moves.
  std::optional<int> pose_format = {};
};

// Keeps a session for each robot's address. A line that is too long closes the connection, because
// its end is unknown. Thread-safe.
class LineProtocol : public RobotProtocol {
 public:
  // `runner` must outlive this. The destructor waits for running jobs.
  explicit LineProtocol(JobRunner& runner, const LineProtocolOptions& options = {})
      : jobs_(runner), options_(options) {}

  std::size_t MessageBytes(std::string_view received) const override;
  RobotReply Answer(const std::string& robot, std::string_view message) override;

 private:
  std::string AnswerLine(RobotSession& session, const LineRequest& request);
  std::string AnswerJob(RobotSession& session, const LineRequest& request);
  std::string ReportOutcome(RobotSession& session, PickOutcome outcome);

  RobotJobs jobs_;
  const LineProtocolOptions options_;
};

}  // namespace graspdb::client
