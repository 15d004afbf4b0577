#include "lab/experiment/own_thresholds.h"

#include <memory>
#include <utility>

#include "base/status_macros.h"

namespace graspdb::lab {

absl::StatusOr<recognition::CatalogueSnapshot> WithOwnThresholds(
    recognition::CatalogueSnapshot taught, const recognition::RecognitionParameters& parameters,
    const recognition::ThresholdProgress& report, Gallery* gallery) {
  ASSIGN_OR_RETURN(const auto proposals,
                   recognition::ProposeThresholds(
                       taught, *gallery, /*object=*/"", parameters, [] { return false; }, report));
  auto poses = *taught.stable_poses;
  for (const recognition::ThresholdProposal& proposal : proposals) {
    if (!proposal.min_score) continue;
    auto& pose = poses.at(proposal.stable_pose);
    auto changed = std::make_shared<recognition::TaughtStablePose>(*pose);
    changed->min_score = proposal.min_score;
    pose = std::move(changed);
  }
  taught.stable_poses = std::make_shared<const decltype(poses)>(std::move(poses));
  return taught;
}

}  // namespace graspdb::lab
