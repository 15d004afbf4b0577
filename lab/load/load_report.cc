#include "lab/load/load_report.h"

namespace graspdb::lab {
namespace {
constexpr int kBins = 10;
}  // namespace

double ShareOf(const Step& step, const Tally& tally) {
  const double all = Milliseconds(tally.latency().Sum());
  return all > 0 ? Milliseconds(step.times.Sum()) / all : 0;
}

std::vector<LatencyBin> BinsOf(const LatencyHistogram& histogram) {
  std::vector<LatencyBin> out;
  if (histogram.count() == 0) return out;
  const std::chrono::nanoseconds low = histogram.Min();
  const std::chrono::nanoseconds width = (histogram.Percentile(99) - low) / kBins;
  std::int64_t below = 0;
  for (int i = 0; i < kBins && width.count() > 0; ++i) {
    const std::chrono::nanoseconds end = low + width * (i + 1);
    const std::int64_t now = histogram.CountBelow(end);
    out.push_back({low + width * i, end, now - below});
    below = now;
  }
  const std::chrono::nanoseconds last = out.empty() ? low : out.back().to;
  if (below < histogram.count()) {
    out.push_back({last, histogram.Max(), histogram.count() - below});
  }
  return out;
}

}  // namespace graspdb::lab
