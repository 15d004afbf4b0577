#include "client/sdk/earlier_servers.h"

namespace graspdb::client {

// Fields that Grasp got after GraspProposal.grasp do not belong here: servers that have them send
// it.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"
v1::Grasp TaughtGraspOf(const v1::GraspProposal& proposal) {
  if (proposal.has_grasp()) return proposal.grasp();
  v1::Grasp out;
  out.set_grasp_id(proposal.grasp_id());
  out.set_approach_distance_m(proposal.approach_distance_m());
  out.set_gripper_opening_m(proposal.gripper_opening_m());
  out.set_priority(proposal.priority());
  out.set_retreat_distance_m(proposal.retreat_distance_m());
  return out;
}
#pragma GCC diagnostic pop

void FillGrasps(v1::RecognizeResponse* response) {
  for (v1::Detection& detection : *response->mutable_detections()) {
    for (v1::GraspProposal& proposal : *detection.mutable_grasps()) {
      if (!proposal.has_grasp()) *proposal.mutable_grasp() = TaughtGraspOf(proposal);
    }
  }
}

}  // namespace graspdb::client
