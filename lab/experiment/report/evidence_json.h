// What speaks for and against an explanation, for programs (tests/eval/fit_confidence.py).
#pragma once

#include <google/protobuf/struct.pb.h>

#include "recognition/verification/confidence.h"

namespace graspdb::client {

// The fields of both, by their names; features under "features".
void FillEvidence(const recognition::Evidence& evidence,
                  const recognition::ConfidenceFeatures& features, google::protobuf::Value* value);

}  // namespace graspdb::client
