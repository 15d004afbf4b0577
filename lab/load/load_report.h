// Reports of a load test.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "graspdb/v1/catalog_service.pb.h"
#include "lab/load/load_run.h"

namespace graspdb::lab {

struct LoadReport {
  std::string server;         // HOST:PORT
  v1::CatalogStatus catalog;  // before the run
  v1::CacheStatus models;     // model cache during the run, of all callers
  std::string frames;         // description of the requests
  std::int64_t warmup = 0;    // requests before the run
  double timeout_s = 0;       // of every request
  LoadPlan plan;
  LoadResult result;
};

// Several lines for a user.
std::string LoadText(const LoadReport& report);

// One line of JSON: everything in the text, and more percentiles. Each key contains its unit (_s,
// _ms, _per_s); shares are 0 to 1. INTERNAL when serialization fails.
absl::StatusOr<std::string> LoadJson(const LoadReport& report);

}  // namespace graspdb::lab
