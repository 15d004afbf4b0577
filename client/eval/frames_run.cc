#include "client/eval/frames_run.h"

#include <algorithm>
#include <iostream>
#include <memory>
#include <vector>

#include "absl/strings/str_format.h"
#include "client/eval/real_frames.h"
#include "client/simulation/progress_line.h"

namespace graspdb::client {
namespace {

const char* TextOf(LostBy lost_by) {
  switch (lost_by) {
    case LostBy::kSegmentation:
      return "no segment of its own";
    case LostBy::kSearch:
      return "not searched there";
    case LostBy::kRanking:
      return "something explains more";
    case LostBy::kConfidence:
      return "not believed";
  }
  return "";
}

void Print(const FrameResult& result) {
  std::cout << absl::StrFormat("%-10s %7.0f ms  %2d segments  %s  (%s)\n", result.frame->name,
                               result.milliseconds, result.segments, result.error,
                               result.frame->arrangement);
  for (const FrameInstance& t : result.instances) {
    std::cout << absl::StrFormat("  %-20s %s\n", t.object.object,
                                 t.found ? "found" : TextOf(t.lost_by));
    std::cout << absl::StrFormat(
        "    true pose: %4d of %5d voxels, score %.3f (own points %.3f), explained %.3f, seen "
        "%.3f, "
        "in sight %.3f, doubts %.3f %.3f %.2f; rank %d\n",
        t.truth.own_points, t.truth.segment_points, t.truth.whole.confidence, t.truth.own_score,
        t.truth.whole.evidence.scan_explained, t.truth.whole.evidence.model_seen,
        t.truth.whole.evidence.in_sight, t.truth.whole.doubt.scan, t.truth.whole.doubt.model,
        t.truth.whole.doubt.residual, t.rank);
    std::cout << absl::StrFormat("    answer: %s%s, score %.3f, F %.3f; truth has F %.3f\n",
                                 t.best_object.empty() ? "nothing" : t.best_object,
                                 t.best_is_right ? " rightly posed" : "", t.best_score,
                                 t.best_explains, t.truth.whole.evidence.score);
  }
  for (const FrameDetection& d : result.detections) {
    std::cout << absl::StrFormat(
        "  accepted %-20s score %.3f  %s (ADD-S %.3f of the diameter); %d voxels, explained %.3f, "
        "seen "
        "%.3f, in sight %.3f, rms %.2f mm, doubts %.3f %.3f %.2f\n",
        d.object, d.score,
        d.again          ? "AGAIN"
        : d.instance     ? "right"
        : d.pose_unknown ? "name only"
                         : "WRONG",
        d.add_s_share, d.voxels, d.evidence.scan_explained, d.evidence.model_seen,
        d.evidence.in_sight, d.evidence.rms_m * 1e3, d.doubt.scan, d.doubt.model, d.doubt.residual);
  }
}

void PrintSums(const std::vector<FrameResult>& results) {
  std::size_t instances = 0;
  std::size_t found = 0;
  std::size_t wrong = 0;
  std::size_t again = 0;
  std::vector<double> times;
  for (const FrameResult& result : results) {
    instances += result.instances.size();
    found +=
        static_cast<std::size_t>(std::ranges::count(result.instances, true, &FrameInstance::found));
    wrong += static_cast<std::size_t>(
        std::ranges::count_if(result.detections, &FrameDetection::IsWrong));
    again += static_cast<std::size_t>(
        std::ranges::count(result.detections, true, &FrameDetection::again));
    times.push_back(result.milliseconds);
  }
  std::ranges::sort(times);
  std::cout << absl::StrFormat(
      "found %d of %d, accepted wrongly %d, found again %d; median %.0f ms, worst %.0f ms\n", found,
      instances, wrong, again, times[times.size() / 2], times.back());
}

}  // namespace

absl::Status RunFrames(const EvalArguments& arguments) {
  const auto frames = LoadFrames(arguments.inputs.front());
  if (!frames.ok()) return frames.status();
  if (frames->empty()) return absl::InvalidArgumentError("frames.json lists no frames");
  ExperimentRun run;
  run.parameters.matching = arguments.matching;
  auto progress = std::make_unique<ProgressLine>();
  run.report = [&](const std::string&, std::size_t done, std::size_t total) {
    progress->Report(static_cast<int>(done), static_cast<int>(total));
  };
  const auto catalogue = FramesCatalogue::Teach(*frames, run);
  progress.reset();
  if (!catalogue.ok()) return catalogue.status();
  std::vector<FrameResult> results;
  for (const RealFrame& frame : *frames) {
    auto result = AskFrame(frame, run, catalogue->get());
    if (!result.ok()) return result.status();
    Print(*result);
    results.push_back(*std::move(result));
  }
  PrintSums(results);
  return absl::OkStatus();
}

}  // namespace graspdb::client
