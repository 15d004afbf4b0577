// Compares a replayed request with its recorded answer.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "graspdb/v1/bundle.pb.h"

namespace graspdb::client {

// The request of a bundle for the replay: without timings in the response.
v1::RecognizeRequest ReplayRequest(const v1::Bundle& bundle);

struct ReplayResult {
  // Bitwise equal except for timings and revision; errors by code and text.
  bool is_same = false;
  std::int64_t revision_then = 0;
  std::int64_t revision_now = 0;  // 0: unknown, e.g. for errors
  // Text of the differences: objects, poses in mm and degrees, scores. Not empty unless is_same.
  std::vector<std::string> differences = {};
};

// Compares `now`, the response to ReplayRequest, with that of the bundle.
ReplayResult CompareReplay(const v1::Bundle& bundle,
                           const absl::StatusOr<v1::RecognizeResponse>& now);

}  // namespace graspdb::client
