// The configured jobs of a cell.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "graspdb/v1/catalog.pb.h"

namespace graspdb::client {

// The protocol that may run a job.
enum class JobProtocol { kAny, kGri, kLine };

// Which poses are primary; the others are related to them.
enum class JobPrimary { kGrasp, kObject };

// What a job does; the last three report the outcome of a grasp.
enum class JobKind { kRecognize, kShowGrasp, kPicked, kMissed, kSlipped };

// A grasp that moves 0.1 m for the approach and for the retreat.
v1::Grasp DefaultGrasp();

struct JobConfig {
  int id = 0;
  JobKind kind = JobKind::kRecognize;
  std::string object = {};  // resource name; empty: any
  std::string label = {};   // empty: any
  JobPrimary primary = JobPrimary::kGrasp;
  JobProtocol protocol = JobProtocol::kAny;
  double min_score = 0;                           // in addition to the server's own limits
  std::optional<absl::Duration> time_limit = {};  // absent: the cell's
  std::size_t max_poses = 0;                      // 0: all
  v1::Grasp shown_grasp = DefaultGrasp();         // kShowGrasp: as it is stored, without the pose
};

// By id.
using Jobs = std::map<int, JobConfig>;

// A job as a line of text: its number, then words.
//   1 any
//   2 object=flange primary=object limit=500ms
//   3 label=brackets min-score=0.8 poses=1
//   80 show=top opening=0.06 approach=0.1 retreat=0.1 priority=1 object=flange
//   91 outcome=picked
// INVALID_ARGUMENT, with the line and the allowed words, for an invalid line.
absl::StatusOr<JobConfig> ParseJob(const std::string& line);

// INVALID_ARGUMENT also for two jobs with the same number.
absl::StatusOr<Jobs> ParseJobs(const std::vector<std::string>& lines);

// Their syntax, for --help.
std::string JobHelp();

}  // namespace graspdb::client
