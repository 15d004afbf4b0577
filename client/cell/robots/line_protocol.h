// The line protocol (docs/line-protocol.md) for RobotServer: for hand-written robot programs, one
// line of ASCII per request and one per reply.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "client/cell/robots/line_request.h"
#include "client/cell/robots/robot_jobs.h"
#include "client/cell/robots/robot_server.h"

namespace graspdb::client {

// Maximum length of a request, its end of line included.
inline constexpr std::size_t kMaxRequestBytes = 256;

struct LineProtocolOptions {
  // Default format, a code of pose_format.h. Without one, robots must send FORMAT: a pose in
  // another vendor's convention looks valid until the arm moves.
  std::optional<int> pose_format = {};
};

// Keeps jobs and pose formats for each robot's address. A line that is too long closes the
// connection, because its end is unknown. Thread-safe.
class LineProtocol : public RobotProtocol {
 public:
  // `runner` must outlive this. The destructor waits for running jobs.
  explicit LineProtocol(JobRunner& runner, const LineProtocolOptions& options = {})
      : jobs_(runner), options_(options) {}

  std::size_t MessageBytes(std::string_view received) const override;
  RobotReply Answer(const std::string& robot, std::string_view message) override;

 private:
  std::string AnswerLine(const std::string& robot, const LineRequest& request);
  std::string AnswerJob(const std::string& robot, const LineRequest& request);
  std::string GivePrimary(const std::string& robot, int job, const JobAnswer& answer, int format);
  std::string AnswerGrasp(const std::string& robot, int job);
  std::string ReportOutcome(const std::string& robot, PickOutcome outcome);
  std::optional<int> FormatOf(const std::string& robot) ABSL_LOCKS_EXCLUDED(mutex_);
  std::string KeepFormat(const std::string& robot, int format) ABSL_LOCKS_EXCLUDED(mutex_);

  RobotJobs jobs_;
  const LineProtocolOptions options_;
  absl::Mutex mutex_;
  std::map<std::string, int> formats_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace graspdb::client
