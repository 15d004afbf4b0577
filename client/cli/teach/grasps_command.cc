#include <cstdio>
#include <map>
#include <memory>
#include <vector>

#include "absl/strings/str_format.h"
#include "base/status_macros.h"
#include "client/cli/teach/commands.h"
#include "recognition/grasps/grasp_proposals.h"

namespace graspdb::client {
namespace {

// The rate by which the server orders grasps.
double RateOf(const v1::GraspOutcomeCounts& counts) {
  return recognition::SuccessRate(
      {counts.picked_count(), counts.missed_count(), counts.slipped_count()});
}

void PrintGrasps(const v1::StablePose& pose) {
  std::map<std::string, v1::GraspOutcomeCounts> reported;
  for (const v1::GraspOutcomeCounts& counts : pose.grasp_outcomes()) {
    reported[counts.grasp_id()] = counts;
  }
  std::printf("%s\n", pose.name().c_str());
  if (pose.grasps().empty()) std::printf("  no grasps\n");
  for (const v1::Grasp& grasp : pose.grasps()) {
    const v1::GraspOutcomeCounts& counts = reported[grasp.grasp_id()];
    std::printf("%s\n",
                absl::StrFormat("  %-20s priority %3d  picked %6d  missed %6d  slipped %6d  "
                                "rate %.2f",
                                grasp.grasp_id(), grasp.priority(), counts.picked_count(),
                                counts.missed_count(), counts.slipped_count(), RateOf(counts))
                    .c_str());
  }
}

absl::Status ListGrasps(const GlobalOptions& global, const std::string& id) {
  ASSIGN_OR_RETURN(const std::vector<v1::StablePose> poses,
                   Connect(global).ListStablePoses(ResourceName("objects", id)));
  for (const v1::StablePose& pose : poses) {
    if (!global.json) {
      PrintGrasps(pose);
    } else {
      RETURN_IF_ERROR(PrintJson(pose));
    }
  }
  if (poses.empty() && !global.json) std::printf("the object has no stable poses\n");
  return absl::OkStatus();
}

absl::Status Report(const GlobalOptions& global, const v1::ReportGraspOutcomeRequest& request) {
  ASSIGN_OR_RETURN(const auto response, Connect(global).ReportGraspOutcome(request));
  if (global.json) return PrintJson(response);
  const v1::GraspOutcomeCounts& counts = response.counts();
  std::printf("%s\n", absl::StrFormat("%s: picked %d, missed %d, slipped %d, rate %.2f",
                                      counts.grasp_id(), counts.picked_count(),
                                      counts.missed_count(), counts.slipped_count(), RateOf(counts))
                          .c_str());
  return absl::OkStatus();
}

void AddReportCommand(CLI::App& grasps, const GlobalOptions& global, Action* action) {
  struct Outcome {
    std::string stable_pose;
    std::string grasp;
    v1::GraspOutcome outcome = v1::GRASP_OUTCOME_UNSPECIFIED;
    int count = 1;
  };
  const std::map<std::string, v1::GraspOutcome> outcomes = {{"picked", v1::GRASP_OUTCOME_PICKED},
                                                            {"missed", v1::GRASP_OUTCOME_MISSED},
                                                            {"slipped", v1::GRASP_OUTCOME_SLIPPED}};
  auto outcome = std::make_shared<Outcome>();
  CLI::App* report = AddCommand(grasps, "report", "Report the outcome of a grasp, as robots do");
  report->add_option("STABLE_POSE", outcome->stable_pose, "Name, objects/ID/stablePoses/ID")
      ->required();
  report->add_option("GRASP", outcome->grasp, "Id of the grasp")->required();
  report->add_option("OUTCOME", outcome->outcome, "picked, missed or slipped")
      ->required()
      ->transform(CLI::Transformer(outcomes, CLI::ignore_case));
  report->add_option("--count", outcome->count, "Number of such outcomes")->capture_default_str();
  report->callback([=, &global] {
    *action = [=, &global] {
      v1::ReportGraspOutcomeRequest request;
      request.set_name(outcome->stable_pose);
      request.set_grasp_id(outcome->grasp);
      request.set_outcome(outcome->outcome);
      request.set_count(outcome->count);
      return Report(global, request);
    };
  });
}

}  // namespace

void AddGraspsCommand(CLI::App& app, const GlobalOptions& global, Action* action) {
  CLI::App* grasps =
      AddCommand(app, "grasps", "List, report and import grasps, with their success rates");
  grasps->require_subcommand(1);
  auto id = std::make_shared<std::string>();
  CLI::App* list = AddCommand(*grasps, "list", "List the grasps of an object with their outcomes");
  list->add_option("OBJECT", *id, "Id, e.g. mug")->required();
  list->callback([=, &global] { *action = [=, &global] { return ListGrasps(global, *id); }; });
  AddReportCommand(*grasps, global, action);
  AddGraspsImportCommand(*grasps, global, action);
}

}  // namespace graspdb::client
