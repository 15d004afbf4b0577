#include <cstdio>
#include <memory>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status_macros.h"
#include "client/cli/base/progress_line.h"
#include "client/cli/objects/commands.h"

namespace graspdb::client {
namespace {

struct ThresholdsOptions {
  std::string id;
  bool apply = false;
};

absl::StatusOr<v1::ProposeThresholdsResponse> Propose(Client& client, const std::string& object) {
  ProgressLine progress;
  return client.ProposeThresholds(object, [&](const v1::ProposeThresholdsResponse& response) {
    if (Interrupted()) return absl::CancelledError("stopped; nothing was changed");
    if (response.view_count() > 0)
      progress.Report(response.done_view_count(), response.view_count());
    return absl::OkStatus();
  });
}

absl::Status Apply(Client& client, const v1::ThresholdProposal& proposal) {
  v1::UpdateStablePoseRequest request;
  request.mutable_stable_pose()->set_name(proposal.stable_pose());
  if (proposal.has_min_score()) {
    request.mutable_stable_pose()->set_min_score(proposal.min_score());
  }
  request.mutable_update_mask()->add_paths("min_score");
  return client.UpdateStablePose(request).status();
}

absl::Status ProposeThresholds(const GlobalOptions& global, const ThresholdsOptions& options) {
  Client client = Connect(global);
  ASSIGN_OR_RETURN(const auto found,
                   Propose(client, options.id.empty() ? "" : ResourceName("objects", options.id)));
  for (const v1::ThresholdProposal& proposal : found.proposals()) {
    if (!global.json) std::printf("%s\n", ThresholdText(proposal).c_str());
    if (!options.apply) continue;
    absl::Status applied = Apply(client, proposal);
    if (!applied.ok()) {
      return WithMessage(applied,
                         absl::StrCat(proposal.stable_pose(), " and those after it keep their ",
                                      "thresholds: ", applied.message()));
    }
  }
  if (global.json) return PrintJson(found);
  if (found.proposals().empty()) {
    std::printf("there are no views to evaluate; teach some with: graspdb import SET\n");
  } else if (!options.apply) {
    std::printf("nothing was changed; --apply sets these thresholds\n");
  }
  return absl::OkStatus();
}

}  // namespace

std::string ThresholdText(const v1::ThresholdProposal& proposal) {
  std::string out = absl::StrFormat(
      "%s: %s; %d of %d views named", proposal.stable_pose(),
      proposal.has_min_score() ? absl::StrFormat("%.2f", proposal.min_score()) : "as all",
      proposal.right_view_count(), proposal.asked_view_count());
  if (proposal.has_right_score()) {
    absl::StrAppendFormat(&out, ", most with %.2f or more", proposal.right_score());
  }
  if (proposal.has_wrong_score()) {
    absl::StrAppendFormat(&out, "; %s taken for it with %.2f", proposal.wrong_view(),
                          proposal.wrong_score());
  }
  return out;
}

void AddThresholdsCommand(CLI::App& objects, const GlobalOptions& global, Action* action) {
  auto options = std::make_shared<ThresholdsOptions>();
  CLI::App* command = AddCommand(
      objects, "thresholds",
      "Propose minimum scores of stable poses: recognises up to eight views of each without "
      "itself, "
      "and without its object, and proposes a lower minimum score for stable poses whose correct "
      "detections score low. Run it again after teaching more.");
  command->add_option("OBJECT", options->id, "Id, e.g. mug; default: all objects");
  command->add_flag("--apply", options->apply,
                    "Set the proposed scores; stable poses without a proposal get the default");
  command->callback(
      [=, &global] { *action = [=, &global] { return ProposeThresholds(global, *options); }; });
}

}  // namespace graspdb::client
