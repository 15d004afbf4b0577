// A load test that was done, to be told.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "graspdb/v1/catalog_service.pb.h"
#include "lab/load/load_run.h"

namespace graspdb::client {

struct LoadReport {
  std::string server;         // HOST:PORT
  v1::CatalogStatus catalog;  // before the run
  v1::CacheStatus models;     // what the server was asked for meanwhile, by whomever
  std::string frames;         // what was sent, in words
  std::int64_t warmup = 0;    // requests before the run
  double timeout_s = 0;       // of every request
  LoadPlan plan;
  LoadResult result;
};

// The percentiles that are told.
inline constexpr std::array kPercentiles = {10.0, 25.0, 50.0, 75.0, 90.0, 95.0, 99.0, 99.9, 99.99};
// Sent later than this after it was due, a request was sent late.
inline constexpr std::chrono::milliseconds kLate{1};

inline double Milliseconds(std::chrono::nanoseconds time) {
  return std::chrono::duration<double, std::milli>(time).count();
}

// The share of the latency that a step had, 0 to 1; of all requests, also of those without it.
double ShareOf(const Step& step, const Tally& tally);

// How many took how long.
struct LatencyBin {
  std::chrono::nanoseconds from{0};
  std::chrono::nanoseconds to{0};  // excluded, but for the last
  std::int64_t count = 0;
};

// Ten bins of one width up to the 99th percentile, and one for the rest: outliers do not press
// all others into the first. Fewer where all took the same time; none without times.
std::vector<LatencyBin> BinsOf(const LatencyHistogram& histogram);

// For a person, some lines.
std::string LoadText(const LoadReport& report);

// For programs, one line: everything that the text says, and a longer ladder of percentiles. The
// unit is in each key (_s, _ms, _per_s); shares are 0 to 1. INTERNAL when the library refuses it.
absl::StatusOr<std::string> LoadJson(const LoadReport& report);

}  // namespace graspdb::client
