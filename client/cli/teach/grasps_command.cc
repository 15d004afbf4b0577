#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status_macros.h"
#include "client/cli/teach/commands.h"
#include "client/teaching/mesh/mesh_grasps.h"
#include "client/teaching/upload/view_upload.h"
#include "files/messages/pose_message.h"
#include "recognition/grasps/grasp_proposals.h"

namespace graspdb::client {
namespace {

struct Options {
  std::string object;
  std::string file;
  std::string frame = "object";
  std::string stable_pose;
  bool dry_run = false;

  bool IsMesh() const { return frame == "mesh"; }
};

constexpr char kImportFooter[] =
    R"(The file is {"grasps": [...]}, as in capture sets and `graspdb teach --dry-run --json`.
--frame object: tcpPose is T_object_tcp of the stable pose that --stable-pose names.
--frame mesh: tcpPose is T_mesh_tcp, in metres; the grasp is added to every stable pose that was
taught from the mesh and in which it is reachable: not from below, 2 mm above the table. Grasps with
the same id are replaced, others are kept.

Examples:
  graspdb grasps import bracket grasps.json --frame mesh --dry-run
  graspdb grasps import bracket grasps.json --stable-pose resting-1)";

// A row of the table; `why` is empty for a grasp that is taken.
void PrintRow(const v1::StablePose& pose, const std::string& grasp, const std::string& why) {
  const std::string id = pose.name().substr(pose.name().rfind('/') + 1);
  std::printf("%-20s %-20s %s\n", id.c_str(), grasp.c_str(),
              why.empty() ? "taken" : ("left out: " + why).c_str());
}

// The grasps of the file that are reachable in the stable pose.
std::vector<v1::Grasp> TakenBy(const v1::StablePose& pose, const std::vector<v1::Grasp>& grasps,
                               bool is_mesh, bool print) {
  if (!is_mesh) {
    for (const v1::Grasp& grasp : grasps) {
      if (print) PrintRow(pose, grasp.grasp_id(), "");
    }
    return grasps;
  }
  std::vector<v1::Grasp> out;
  for (const v1::Grasp& given : grasps) {
    const v1::Grasp grasp = FromMesh(given, files::FromMessage(pose.mesh_pose()));
    std::string why = WhyOutOfReach(grasp);
    if (why.empty()) {
      out.push_back(grasp);
    } else if (std::ranges::find(pose.grasps(), grasp.grasp_id(), &v1::Grasp::grasp_id) !=
               pose.grasps().end()) {
      why += "; the existing grasp is kept";
    }
    if (print) PrintRow(pose, grasp.grasp_id(), why);
  }
  return out;
}

absl::Status Write(Client& client, const v1::StablePose& pose) {
  v1::UpdateStablePoseRequest request;
  request.mutable_stable_pose()->set_name(pose.name());
  request.mutable_stable_pose()->set_etag(pose.etag());
  *request.mutable_stable_pose()->mutable_grasps() = pose.grasps();
  request.mutable_update_mask()->add_paths("grasps");
  return client.UpdateStablePose(request).status();
}

absl::StatusOr<std::vector<v1::StablePose>> PosesOf(Client& client, const Options& options) {
  if (options.stable_pose.empty()) {
    return client.ListStablePoses(ResourceName("objects", options.object));
  }
  ASSIGN_OR_RETURN(auto one,
                   client.GetStablePose(StablePoseName(options.object, options.stable_pose)));
  return std::vector<v1::StablePose>{std::move(one)};
}

absl::Status Give(Client& client, const GlobalOptions& global, const Options& options,
                  const std::vector<v1::Grasp>& grasps, v1::StablePose pose) {
  const std::vector<v1::Grasp> taken = TakenBy(pose, grasps, options.IsMesh(), !global.json);
  if (taken.empty()) return absl::OkStatus();
  const auto merged = Merged({pose.grasps().begin(), pose.grasps().end()}, taken);
  pose.mutable_grasps()->Assign(merged.begin(), merged.end());
  if (!options.dry_run) {
    RETURN_IF_ERROR(Write(client, pose));
  }
  return global.json ? PrintJson(pose) : absl::OkStatus();
}

absl::Status Import(const GlobalOptions& global, const Options& options) {
  if (!options.IsMesh() && options.stable_pose.empty()) {
    return WrongUsage(absl::InvalidArgumentError(
        "grasps in the object's frame belong to one stable pose; name it with --stable-pose, or "
        "give --frame mesh"));
  }
  ASSIGN_OR_RETURN(const auto grasps, LoadGrasps(options.file));
  RETURN_IF_ERROR(options.IsMesh() ? CheckForMesh(grasps) : absl::OkStatus());
  Client client = Connect(global);
  ASSIGN_OR_RETURN(const auto poses, PosesOf(client, options));
  std::size_t updated = 0;
  for (const v1::StablePose& pose : poses) {
    if (options.IsMesh() && !pose.has_mesh_pose()) {
      std::fprintf(stderr, "graspdb: %s has no mesh frame; teach it again with --mesh\n",
                   pose.name().c_str());
      continue;
    }
    ++updated;
    absl::Status given = Give(client, global, options, grasps, pose);
    if (!given.ok()) {
      return WithMessage(given, absl::StrCat(pose.name(), ": ", given.message()));
    }
  }
  if (updated > 0) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrCat(
      "no stable pose of ", options.object, " has a mesh frame; teach it again: graspdb teach ",
      options.object, " --mesh FILE --unit UNIT"));
}

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

void AddGraspsImportCommand(CLI::App& grasps, const GlobalOptions& global, Action* action) {
  auto options = std::make_shared<Options>();
  CLI::App* command = AddCommand(grasps, "import", "Add the grasps of a file to an object");
  command->add_option("OBJECT", options->object, "Id, e.g. mug")->required();
  command->add_option("FILE", options->file, "JSON file of grasps")->required();
  command->add_option("--frame", options->frame, "Frame of the grasps: object or mesh")
      ->check(CLI::IsMember({"object", "mesh"}))
      ->capture_default_str();
  command->add_option("--stable-pose", options->stable_pose,
                      "Id of the stable pose to change; default with --frame mesh: all");
  command->add_flag("--dry-run", options->dry_run,
                    "Print which grasps would be taken; change nothing");
  command->footer(kImportFooter);
  command->callback([=, &global] { *action = [=, &global] { return Import(global, *options); }; });
}

}  // namespace graspdb::client
