// Results and durations of the pipeline's steps.
#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <vector>

namespace graspdb::recognition {

// One step; steps that run for every cluster are summed, also over parallel clusters.
struct StageReport {
  std::string stage;
  std::size_t input_points = 0;
  std::size_t output_points = 0;
  double duration_ms = 0;
};

// Collects the reports in the order in which the steps first ran. Not thread-safe.
class StageLog {
 public:
  // Runs `step`, which returns its number of output points.
  template <typename Step>
  void Measure(std::string_view stage, std::size_t input_points, Step&& step) {
    const auto start = std::chrono::steady_clock::now();
    const std::size_t output_points = step();
    const std::chrono::duration<double, std::milli> spent =
        std::chrono::steady_clock::now() - start;
    StageReport& report = Find(stage);
    report.input_points += input_points;
    report.output_points += output_points;
    report.duration_ms += spent.count();
  }

  // Adds the reports of another log, of the same or further steps.
  void Add(const StageLog& other) {
    for (const StageReport& report : other.reports_) {
      StageReport& sum = Find(report.stage);
      sum.input_points += report.input_points;
      sum.output_points += report.output_points;
      sum.duration_ms += report.duration_ms;
    }
  }

  const std::vector<StageReport>& reports() const { return reports_; }

 private:
  StageReport& Find(std::string_view stage) {
    for (StageReport& report : reports_) {
      if (report.stage == stage) return report;
    }
    return reports_.emplace_back(StageReport{std::string(stage)});
  }

  std::vector<StageReport> reports_;
};

}  // namespace graspdb::recognition
