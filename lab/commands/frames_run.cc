#include "lab/commands/frames_run.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "absl/strings/str_format.h"
#include "client/cli/base/progress_line.h"
#include "files/atomic_file.h"
#include "files/point_file.h"
#include "lab/commands/frame_picture.h"
#include "lab/experiment/real_frames.h"
#include "lab/experiment/report/report_json.h"

namespace graspdb::client {
namespace {

void Print(const FrameInstance& t) {
  std::cout << absl::StrFormat("  %-20s %s\n", t.object.object,
                               t.found ? "found" : TextOf(t.lost_by));
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

absl::Status WritePicture(const EvalArguments& arguments, const FrameResult& result) {
  if (arguments.out.empty()) return absl::OkStatus();
  const std::filesystem::path folder(arguments.out);
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    return absl::FailedPreconditionError("cannot make the folder " + arguments.out + ": " +
                                         error.message());
  }
  const auto file = ReadPointFile(result.frame->path);
  if (!file.ok()) return file.status();
  return WriteShadedPicture(folder / (result.frame->name + ".png"),
                            DrawFrame(result, file->points));
}

absl::Status WriteReport(const EvalArguments& arguments, const std::vector<FrameResult>& results) {
  if (arguments.out.empty()) return absl::OkStatus();
  const auto text = FramesJson(arguments.command, results);
  if (!text.ok()) return text.status();
  const std::filesystem::path file = std::filesystem::path(arguments.out) / "report.json";
  absl::Status written = WriteFileAtomically(file, *text, Durability::kProcessCrash);
  if (written.ok()) {
    std::cout << "report: " << file.string() << ", with a picture of each frame beside it\n";
  }
  return written;
}

}  // namespace

absl::Status RunFrames(const EvalArguments& arguments) {
  const auto frames = LoadFrames(arguments.inputs.front());
  if (!frames.ok()) return frames.status();
  if (frames->empty()) return absl::InvalidArgumentError("frames.json lists no frames");
  ExperimentRun run;
  run.parameters.matching = arguments.matching;
  run.parameters.scene.enabled = arguments.in_image;
  auto progress = std::make_unique<ProgressLine>();
  run.report = [&](const std::string&, std::size_t done, std::size_t total) {
    progress->Report(static_cast<int>(done), static_cast<int>(total));
  };
  const auto catalogue = FramesCatalogue::Teach(*frames, run);
  progress.reset();
  if (!catalogue.ok()) return catalogue.status();
  std::vector<FrameResult> results;
  for (const RealFrame& frame : *frames) {
    auto result = RecognizeFrame(frame, run, catalogue->get());
    if (!result.ok()) return result.status();
    Print(*result, arguments.list);
    if (absl::Status put = WritePicture(arguments, *result); !put.ok()) return put;
    results.push_back(*std::move(result));
  }
  PrintSums(results);
  return WriteReport(arguments, results);
}

}  // namespace graspdb::client
