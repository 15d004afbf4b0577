// Inputs that are known to take too long or too much memory, and that fuzzers pass over until that
// is mended: what is farther apart than one object or one table is, and what is right before the
// lens. To be deleted with what it tells of.
#pragma once

#include "graspdb/v1/recognition_service.pb.h"
#include "tests/fuzz/operations.pb.h"

namespace graspdb::fuzz {

bool IsOpenIssue(const v1::RecognizeRequest& request);
bool IsOpenIssue(const Uploads& uploads);
bool IsOpenIssue(const Operation& operation);
bool IsOpenIssue(const StoredDatabase& database);

}  // namespace graspdb::fuzz
