// What speaks for and against an explanation, for programs (tests/eval/fit_confidence.py).
#pragma once

#include <google/protobuf/struct.pb.h>

#include "recognition/confidence.h"

namespace graspdb::client {

// The fields of both, by their names; doubts under "doubt".
void FillEvidence(const recognition::Evidence& evidence, const recognition::Doubt& doubt,
                  google::protobuf::Value* value);

}  // namespace graspdb::client
