// The line protocol (docs/line-protocol.md) as a protocol for RobotServer: for robot programs that
// are written by hand, a line of ASCII a question and a line an answer.
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

// No request is longer, its end of line included.
inline constexpr std::size_t kLongestRequest = 256;

struct LineProtocolOptions {
  // A code of pose_format.h, for robots that say no FORMAT. Without one they must: a pose in
  // another vendor's convention looks like a good one until the arm moves.
  std::optional<int> pose_format = {};
};

// Keeps jobs and pose formats for each robot's address. After a line that is too long, whose end
// may be anywhere, it hangs up. Thread-safe.
class LineProtocol : public RobotProtocol {
 public:
  // `runner` must outlive this. The destructor waits for jobs that run.
  explicit LineProtocol(JobRunner& runner, const LineProtocolOptions& options = {})
      : jobs_(runner), options_(options) {}

  std::size_t MessageBytes(std::string_view received) const override;
  RobotReply Answer(const std::string& robot, std::string_view message) override;

 private:
  std::string AnswerLine(const std::string& robot, const LineRequest& request);
  std::string AnswerJob(const std::string& robot, const LineRequest& request);
  std::string GivePrimary(const std::string& robot, int job, const JobAnswer& answer, int format);
  std::string AnswerGrasp(const std::string& robot, int job);
  std::string Tell(const std::string& robot, PickOutcome outcome);
  std::optional<int> FormatOf(const std::string& robot) ABSL_LOCKS_EXCLUDED(mutex_);
  std::string KeepFormat(const std::string& robot, int format) ABSL_LOCKS_EXCLUDED(mutex_);

  RobotJobs jobs_;
  const LineProtocolOptions options_;
  absl::Mutex mutex_;
  std::map<std::string, int> formats_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace graspdb::client
