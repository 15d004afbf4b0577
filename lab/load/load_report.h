// Reports of a load test.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

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

// The percentiles of the report.
inline constexpr std::array kPercentiles = {10.0, 25.0, 50.0, 75.0, 90.0, 95.0, 99.0, 99.9, 99.99};

// Number of requests by latency.
struct LatencyBin {
  std::chrono::nanoseconds from{0};
  std::chrono::nanoseconds to{0};  // excluded, except for the last
  std::int64_t count = 0;
};

// Ten bins of equal width up to the 99th percentile and one for the rest, so that outliers do not
// compress all others into the first. Fewer if all times are equal; none without times.
std::vector<LatencyBin> BinsOf(const LatencyHistogram& histogram);

// Several lines for a user.
std::string LoadText(const LoadReport& report);

// One line of JSON: everything in the text, and more percentiles. Each key contains its unit (_s,
// _ms, _per_s); shares are 0 to 1. INTERNAL when serialization fails.
absl::StatusOr<std::string> LoadJson(const LoadReport& report);

}  // namespace graspdb::lab
