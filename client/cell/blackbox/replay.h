// Whether a request gets the answer again that it got.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "graspdb/v1/bundle.pb.h"

namespace graspdb::client {

// The request of a bundle as it is asked again: so that nothing that a clock measured is answered.
v1::RecognizeRequest ReplayRequest(const v1::Bundle& bundle);

struct ReplayResult {
  // Bit for bit but for what a clock measured and for the revision; errors by code and text.
  bool is_same = false;
  std::int64_t revision_then = 0;
  std::int64_t revision_now = 0;  // 0: not known, as with errors
  // What differs, in words: objects, poses in mm and degrees, scores. Not empty where not the same.
  std::vector<std::string> differences = {};
};

// Compares `now`, the answer to ReplayRequest, with what the bundle has.
ReplayResult CompareReplay(const v1::Bundle& bundle,
                           const absl::StatusOr<v1::RecognizeResponse>& now);

}  // namespace graspdb::client
