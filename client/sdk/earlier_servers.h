// Answers of servers that were built from an earlier state of the contract.
#pragma once

#include "graspdb/v1/recognition.pb.h"
#include "graspdb/v1/recognition_service.pb.h"

namespace graspdb::client {

// The taught grasp of `proposal`. A server of before GraspProposal.grasp sends deprecated fields
// only: then the grasp is made of these, and has neither tcp_pose nor free_turn.
v1::Grasp TaughtGraspOf(const v1::GraspProposal& proposal);

// Sets `grasp` of all proposals to TaughtGraspOf, so that callers need not distinguish servers.
void FillGrasps(v1::RecognizeResponse* response);

}  // namespace graspdb::client
