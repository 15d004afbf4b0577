#include "client/archive/archive_outcomes.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "base/status_macros.h"

namespace graspdb::client {
namespace {

// The contract's limit for a report.
constexpr std::int64_t kOutcomesPerReport = 10'000;
// Counts above are treated as this one: 100 reports. Grasps are ranked by shares, which hardly
// differ from there on.
constexpr std::int64_t kMaxRaisedCount = 1'000'000;

// By grasp.
using OutcomeCounts = std::map<std::string, v1::GraspOutcomeCounts>;

OutcomeCounts CountsOf(const v1::StablePose& pose) {
  OutcomeCounts out;
  for (const v1::GraspOutcomeCounts& counts : pose.grasp_outcomes()) {
    out[counts.grasp_id()] = counts;
  }
  return out;
}

std::int64_t Missing(std::int64_t file, std::int64_t server) {
  return std::clamp<std::int64_t>(file, 0, kMaxRaisedCount) -
         std::clamp<std::int64_t>(server, 0, kMaxRaisedCount);
}

// Whether anything was reported.
absl::StatusOr<bool> RaiseGrasp(const std::string& pose, const v1::GraspOutcomeCounts& file,
                                const v1::GraspOutcomeCounts& server, Client& client,
                                const std::function<absl::Status()>& go_on) {
  v1::ReportGraspOutcomeRequest request;
  request.set_name(pose);
  request.set_grasp_id(file.grasp_id());
  bool raised = false;
  const std::array<std::pair<v1::GraspOutcome, std::int64_t>, 3> missing = {{
      {v1::GRASP_OUTCOME_PICKED, Missing(file.picked_count(), server.picked_count())},
      {v1::GRASP_OUTCOME_MISSED, Missing(file.missed_count(), server.missed_count())},
      {v1::GRASP_OUTCOME_SLIPPED, Missing(file.slipped_count(), server.slipped_count())},
  }};
  for (auto [outcome, count] : missing) {
    request.set_outcome(outcome);
    for (; count > 0; count -= kOutcomesPerReport) {
      RETURN_IF_ERROR(go_on());
      request.set_count(static_cast<int>(std::min(count, kOutcomesPerReport)));
      RETURN_IF_ERROR(client.ReportGraspOutcome(request).status());
      raised = true;
    }
  }
  return raised;
}

}  // namespace

absl::StatusOr<bool> RaiseOutcomesTo(const v1::StablePose& file, Client& client,
                                     const std::function<absl::Status()>& go_on) {
  if (file.grasp_outcomes().empty()) return false;
  ASSIGN_OR_RETURN(const v1::StablePose server, client.GetStablePose(file.name()));
  const OutcomeCounts wanted = CountsOf(file);
  OutcomeCounts counted = CountsOf(server);
  bool raised = false;
  // The server's grasps, of which there are few: the file may have counts of others.
  for (const v1::Grasp& grasp : server.grasps()) {
    const auto found = wanted.find(grasp.grasp_id());
    if (found == wanted.end()) continue;
    ASSIGN_OR_RETURN(const bool done, RaiseGrasp(file.name(), found->second,
                                                 counted[grasp.grasp_id()], client, go_on));
    raised |= done;
  }
  return raised;
}

}  // namespace graspdb::client
