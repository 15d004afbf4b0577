#include "lab/experiment/report/case_curves.h"

#include <algorithm>

#include "lab/experiment/report/case_figures.h"

namespace graspdb::client {
namespace {

constexpr double kLargestAddS = 0.1;  // of the diameter
constexpr int kAddSSteps = 40;
constexpr int kScoreSteps = 50;
constexpr std::size_t kBins = 10;

bool NamesAnObject(const Answer& answer) { return !answer.stable_pose.empty(); }

bool IsAllRight(const Answer& answer) { return answer.known && answer.pose_right; }

double Share(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0 : static_cast<double>(part) / static_cast<double>(whole);
}

std::size_t KnownCount(const CaseResult& result) {
  return static_cast<std::size_t>(std::ranges::count_if(result.answers, &Answer::known));
}

}  // namespace

Curve RecallOverAddS(const CaseResult& result) {
  Curve out;
  const std::size_t known = KnownCount(result);
  if (known == 0) return out;
  for (int i = 0; i <= kAddSSteps; ++i) {
    const double allowed = kLargestAddS * i / kAddSSteps;
    const auto right = std::ranges::count_if(result.answers, [&](const Answer& a) {
      return a.known && a.object_right &&
             a.error.add_s_m <= allowed * result.set.shapes[a.part]->diameter_m;
    });
    out.emplace_back(allowed, Share(static_cast<std::size_t>(right), known));
  }
  return out;
}

ScoreCurves OverScore(const CaseResult& result) {
  ScoreCurves out;
  const std::size_t known = KnownCount(result);
  for (int i = 0; i <= kScoreSteps; ++i) {
    const double threshold = static_cast<double>(i) / kScoreSteps;
    std::size_t left = 0;
    std::size_t right = 0;
    for (const Answer& a : result.answers) {
      if (!NamesAnObject(a) || a.score < threshold) continue;
      ++left;
      right += IsAllRight(a);
    }
    if (left > 0) out.precision.emplace_back(threshold, Share(right, left));
    if (known > 0) out.recall.emplace_back(threshold, Share(right, known));
  }
  return out;
}

std::vector<ScoreBin> ReliabilityBins(const CaseResult& result) {
  std::vector<ScoreBin> bins(kBins);
  for (std::size_t i = 0; i < kBins; ++i) {
    bins[i].low = static_cast<double>(i) / static_cast<double>(kBins);
  }
  for (const Answer& a : result.answers) {
    if (!NamesAnObject(a)) continue;
    const double place = std::clamp(a.score, 0.0, 1.0) * static_cast<double>(kBins);
    ScoreBin& bin = bins[std::min(static_cast<std::size_t>(place), kBins - 1)];
    ++bin.count;
    bin.right += IsAllRight(a);
  }
  for (ScoreBin& bin : bins) {
    if (bin.count > 0) bin.right /= static_cast<double>(bin.count);
  }
  return bins;
}

Confusions ConfusionsOf(const CaseResult& result) {
  Confusions out;
  for (const Answer& a : result.answers) {
    ++out[{result.set.parts[a.part].object_id, ObjectOf(a.stable_pose)}];
  }
  return out;
}

}  // namespace graspdb::client
