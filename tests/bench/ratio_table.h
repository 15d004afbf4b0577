// Times of several programs for the same work, as ratios.
#pragma once

#include <benchmark/benchmark.h>

#include <map>
#include <ostream>
#include <string>
#include <vector>

namespace graspdb::bench {

// Prints like Google Benchmark's console reporter and keeps every repetition's time.
class RatioTable : public benchmark::ConsoleReporter {
 public:
  RatioTable() : ConsoleReporter(OO_Tabular) {}
  void ReportRuns(const std::vector<Run>& runs) override;

  // A Markdown table by benchmark, with one row per program, ours first: median time and its range,
  // the ratio to our time, and its range from the extreme repetitions.
  void Write(std::ostream& out) const;

 private:
  struct Times {
    std::vector<double> milliseconds;
    std::string figures;  // counters of the last repetition
  };
  std::map<std::string, std::vector<std::pair<std::string, Times>>> by_work_;
};

}  // namespace graspdb::bench
