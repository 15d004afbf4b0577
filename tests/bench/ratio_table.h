// Times of several programs for the same work, as ratios.
#pragma once

#include <benchmark/benchmark.h>

#include <map>
#include <ostream>
#include <string>
#include <vector>

namespace graspdb::bench {

// Prints what Google Benchmark's console prints and keeps every repetition's time.
class RatioTable : public benchmark::ConsoleReporter {
 public:
  RatioTable() : ConsoleReporter(OO_Tabular) {}
  void ReportRuns(const std::vector<Run>& runs) override;

  // A Markdown table by the works' names, a row a program, ours first: median time and its range,
  // how often our time fits into it, and the range of that from the repetitions' extremes.
  void Write(std::ostream& out) const;

 private:
  struct Times {
    std::vector<double> milliseconds;
    std::string figures;  // counters, as the last repetition had them
  };
  std::map<std::string, std::vector<std::pair<std::string, Times>>> by_work_;
};

}  // namespace graspdb::bench
