#include "tests/bench/ratio_table.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace graspdb::bench {
namespace {

constexpr char kSeparator[] = " | ";
constexpr char kOurs[] = "graspdb";

double Median(std::vector<double> values) {
  std::ranges::sort(values);
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

std::string Range(const std::vector<double>& values) {
  const auto [least, most] = std::ranges::minmax(values);
  return absl::StrFormat("%.3g to %.3g", least, most);
}

std::string FiguresOf(const benchmark::UserCounters& counters) {
  std::string out;
  for (const auto& [name, counter] : counters) {
    absl::StrAppend(&out, out.empty() ? "" : ", ", absl::StrFormat("%s %.4g", name, counter.value));
  }
  std::ranges::replace(out, '_', ' ');
  return out;
}

}  // namespace

void RatioTable::ReportRuns(const std::vector<Run>& runs) {
  ConsoleReporter::ReportRuns(runs);
  for (const Run& run : runs) {
    if (run.run_type != Run::RT_Iteration || run.error_occurred) continue;
    const std::string& name = run.run_name.function_name;
    const std::size_t at = name.rfind(kSeparator);
    if (at == std::string::npos) continue;
    const std::string work = name.substr(0, at);
    const std::string program = name.substr(at + sizeof(kSeparator) - 1);
    auto& rows = by_work_[work];
    auto row = std::ranges::find(rows, program, [](const auto& r) { return r.first; });
    if (row == rows.end()) row = rows.insert(rows.end(), {program, {}});
    row->second.milliseconds.push_back(run.GetAdjustedRealTime());
    row->second.figures = FiguresOf(run.counters);
  }
}

void RatioTable::Write(std::ostream& out) const {
  out << "| work | program | median, ms | range, ms | times ours | range | figures |\n"
         "| --- | --- | --- | --- | --- | --- | --- |\n";
  for (const auto& [work, unordered] : by_work_) {
    auto rows = unordered;
    std::ranges::stable_sort(rows, {}, [](const auto& r) {
      return std::pair(r.first != kOurs, Median(r.second.milliseconds));
    });
    const auto ours = std::ranges::find(rows, kOurs, [](const auto& r) { return r.first; });
    for (const auto& [program, times] : rows) {
      out << "| " << work << " | " << program << " | "
          << absl::StrFormat("%.3g", Median(times.milliseconds)) << " | "
          << Range(times.milliseconds) << " | ";
      if (ours != rows.end() && program != kOurs) {
        const auto [our_least, our_most] = std::ranges::minmax(ours->second.milliseconds);
        const auto [least, most] = std::ranges::minmax(times.milliseconds);
        out << absl::StrFormat("**%.1f** | %.1f to %.1f",
                               Median(times.milliseconds) / Median(ours->second.milliseconds),
                               least / our_most, most / our_least);
      } else {
        out << "1 | ";
      }
      out << " | " << times.figures << " |\n";
    }
  }
}

}  // namespace graspdb::bench
