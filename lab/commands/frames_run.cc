#include "lab/commands/frames_run.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "absl/strings/str_format.h"
#include "base/status_macros.h"
#include "client/cli/base/progress_line.h"
#include "lab/commands/frame_picture.h"
#include "lab/experiment/real_frames.h"
#include "lab/experiment/report/frames_report.h"
#include "lab/experiment/report/report_markdown.h"
#include "lab/experiment/trials/composites.h"
#include "rendering/random/counter_random.h"

namespace graspdb::lab {
namespace {

void Print(const FrameInstance& t) {
  std::cout << absl::StrFormat("  %-20s %s\n", t.object.object,
                               t.found ? "found" : TextOf(t.lost_by));
  if (!t.found) {
    std::cout << absl::StrFormat("    not %s; by segments %s, in the image %s\n",
                                 TextOf(After(t.stage())), TextOf(t.by_segments),
                                 TextOf(t.in_image));
  }
  std::cout << absl::StrFormat("    true pose: rank %d, %s\n", t.rank, TextOf(t.truth));
  std::cout << absl::StrFormat(
      "    answer: %s%s, score %.3f, F %.3f\n", t.best_object.empty() ? "nothing" : t.best_object,
      t.best_is_right ? " rightly posed" : "", t.best_score, t.best_explains);
}

void Print(const FrameDetection& d) {
  const char* judged = d.again          ? "AGAIN"
                       : d.instance     ? "right"
                       : d.pose_unknown ? "name only"
                                        : "WRONG";
  const std::string error = std::isfinite(d.add_s_share)
                                ? absl::StrFormat("ADD-S %.3f of the diameter", d.add_s_share)
                                : "the frame has no pose of it";
  std::cout << absl::StrFormat("  accepted %-20s score %.3f  %s (%s); %d voxels, %s\n", d.object,
                               d.score, judged, error, d.voxels, TextOf(d.evidence, d.features));
}

void Print(const FrameResult& result, bool list) {
  std::cout << absl::StrFormat("%-10s %7.0f ms  %2d segments  %s  (%s)\n", result.frame->name,
                               result.milliseconds, result.segments, result.error,
                               result.frame->arrangement);
  // Steps on several cores add up to more than the total.
  for (const auto& stage : result.stages) {
    if (list) std::cout << absl::StrFormat("  %s %.0f ms", stage.stage, stage.duration_ms);
  }
  if (list) std::cout << "\n";
  for (const FrameInstance& t : result.instances) Print(t);
  for (const FrameDetection& d : result.detections) Print(d);
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

absl::Status WritePicture(const EvalArguments& arguments, const FrameResult& result,
                          const recognition::Points& points) {
  if (arguments.out.empty()) return absl::OkStatus();
  const std::filesystem::path folder(arguments.out);
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    return absl::FailedPreconditionError("cannot make the folder " + arguments.out + ": " +
                                         error.message());
  }
  return pictures::WriteShadedPicture(folder / (result.frame->name + ".png"),
                                      DrawFrame(result, points));
}

absl::Status WriteReport(const EvalArguments& arguments, const FramesCatalogue& catalogue,
                         const std::vector<FrameResult>& results) {
  if (arguments.out.empty()) return absl::OkStatus();
  const std::filesystem::path folder(arguments.out);
  absl::Status written =
      WriteFramesReport(folder, arguments.command, catalogue.object_ids(), results);
  if (written.ok()) {
    std::cout << "report: " << (folder / "report.json").string()
              << ", with stages, BOP results and a picture of each frame beside it\n";
  }
  return written;
}

// Calls `recognize` with the frame, or with `composited` scenes that are rendered into it. Errors
// of `recognize`.
template <typename Recognize>
absl::Status Show(const RealFrame& frame, int composited, std::uint64_t seed,
                  const ExperimentRun& run, const PartSet& set, const Recognize& recognize) {
  constexpr int kMaxPlaced = 4;
  ASSIGN_OR_RETURN(const auto scan, ReadScan(frame));
  if (composited == 0) return recognize(frame, scan);
  for (int i = 0; i < composited; ++i) {
    auto composite =
        Compose(frame, scan, set, run.parameters,
                {.objects = 1 + i % kMaxPlaced,
                 .seed = rendering::RandomBits(seed, 1, static_cast<std::uint64_t>(i))});
    if (absl::IsFailedPrecondition(composite.status())) return absl::OkStatus();  // no table
    if (!composite.ok()) return composite.status();
    composite->frame.name += absl::StrFormat("-%d", i + 1);
    RETURN_IF_ERROR(recognize(composite->frame, composite->scan));
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status RunFrames(const EvalArguments& arguments) {
  ASSIGN_OR_RETURN(const auto frames, LoadFrames(arguments.inputs.front()));
  if (frames.empty()) return absl::InvalidArgumentError("frames.json lists no frames");
  ExperimentRun run;
  run.parameters.matching = arguments.matching;
  run.parameters.scene.verify = !arguments.without_image;
  run.parameters.scene.search = !arguments.without_search && !arguments.without_image;
  auto progress = std::make_unique<client::ProgressLine>();
  run.report = [&](const std::string&, std::size_t done, std::size_t total) {
    progress->Report(static_cast<int>(done), static_cast<int>(total));
  };
  const auto catalogue = FramesCatalogue::Teach(frames, run);
  progress.reset();
  if (!catalogue.ok()) return catalogue.status();
  std::deque<RealFrame> shown;  // of the results
  std::vector<FrameResult> results;
  const auto recognize = [&](RealFrame frame, const recognition::Scan& scan) {
    shown.push_back(std::move(frame));
    results.push_back(RecognizeFrame(shown.back(), scan, run, catalogue->get()));
    Print(results.back(), arguments.list);
    return WritePicture(arguments, results.back(), scan.points);
  };
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const std::uint64_t seed = rendering::RandomBits(arguments.seed, 0, i);
    RETURN_IF_ERROR(
        Show(frames[i], arguments.composited, seed, run, (*catalogue)->set(), recognize));
  }
  if (results.empty()) return absl::InvalidArgumentError("no frame shows a table to render onto");
  PrintSums(results);
  std::cout << TableMarkdown(StageTable(results));
  return WriteReport(arguments, **catalogue, results);
}

}  // namespace graspdb::lab
