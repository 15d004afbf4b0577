#include <algorithm>
#include <cmath>
#include <deque>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <tuple>
#include <utility>
#include <vector>

#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "base/status_macros.h"
#include "client/cli/base/progress_line.h"
#include "lab/commands/eval_run.h"
#include "lab/experiment/report/report_json.h"
#include "lab/experiment/report/report_writer.h"
#include "lab/experiment/trials/composites.h"
#include "recognition/verification/visibility.h"
#include "rendering/random/counter_random.h"

namespace graspdb::lab {
namespace {

using Eigen::Vector3f;

// Pixels: fewer than the cameras have, so that every row and column has a measurement.
constexpr int kWidth = 480;
constexpr int kMaxHeight = 480;
// This share of the tangents is cut off at either end, as stray points.
constexpr double kStrayShare = 0.002;
// Stride of the points of a model that are drawn: the scan shows between them.
constexpr std::size_t kDrawnStride = 2;
// Grey of the farthest and of the nearest point.
constexpr float kFarGrey = 30;
constexpr float kNearGrey = 230;
// Grey levels per mm of approach between neighbouring pixels.
constexpr float kGreyPerMm = 6;

bool IsInFront(const Vector3f& p) { return p.allFinite() && p.z() > 0; }

// The values at a share of `kStrayShare` from either end; both 0 without values.
std::pair<float, float> RangeOf(std::vector<float> values) {
  if (values.empty()) return {0, 0};
  std::ranges::sort(values);
  const auto cut = static_cast<std::size_t>(kStrayShare * static_cast<double>(values.size()));
  return {values[cut], values[values.size() - 1 - cut]};
}

// A pinhole camera whose image the scan fills.
class Image {
 public:
  explicit Image(const recognition::Points& scan) {
    std::vector<float> across;
    std::vector<float> down;
    std::vector<float> depths;
    for (const Vector3f& p : scan) {
      if (!IsInFront(p)) continue;
      across.push_back(p.x() / p.z());
      down.push_back(p.y() / p.z());
      depths.push_back(p.z());
    }
    const auto [left, right] = RangeOf(std::move(across));
    const auto [top, bottom] = RangeOf(std::move(down));
    std::tie(nearest_, farthest_) = RangeOf(std::move(depths));
    left_ = left;
    top_ = top;
    pixels_ = static_cast<float>(kWidth - 1) / std::max(right - left, 1e-6F);
    height_ = std::clamp(static_cast<int>((bottom - top) * pixels_) + 1, 1, kMaxHeight);
    depth_.resize(static_cast<std::size_t>(kWidth) * static_cast<std::size_t>(height_));
    for (const Vector3f& p : scan) {
      const auto at = PixelOf(p);
      if (!at) continue;
      float& here = depth_[*at];
      if (here == 0 || p.z() < here) here = p.z();
    }
  }

  std::optional<std::size_t> PixelOf(const Vector3f& p) const {
    if (!IsInFront(p)) return std::nullopt;
    const float x = (p.x() / p.z() - left_) * pixels_;
    const float y = (p.y() / p.z() - top_) * pixels_;
    const bool inside =
        x >= 0 && y >= 0 && x < static_cast<float>(kWidth) && y < static_cast<float>(height_);
    if (!inside) return std::nullopt;
    return static_cast<std::size_t>(y) * kWidth + static_cast<std::size_t>(x);
  }

  std::vector<std::uint8_t> Brightness() const {
    std::vector<std::uint8_t> out(depth_.size());
    const float range = std::max(farthest_ - nearest_, 1e-6F);
    for (std::size_t i = 0; i < depth_.size(); ++i) {
      if (depth_[i] == 0) continue;
      const float far = std::clamp((depth_[i] - nearest_) / range, 0.0F, 1.0F);
      const bool has_left = i % kWidth > 0 && depth_[i - 1] > 0;
      const float slope = has_left ? 1000 * (depth_[i - 1] - depth_[i]) : 0;
      const float grey = kNearGrey + far * (kFarGrey - kNearGrey) + kGreyPerMm * slope;
      out[i] = static_cast<std::uint8_t>(std::clamp(grey, kFarGrey, 255.0F));
    }
    return out;
  }

  int height() const { return height_; }

 private:
  float left_ = 0;
  float top_ = 0;
  float pixels_ = 1;  // of a tangent of 1
  float nearest_ = 0;
  float farthest_ = 0;
  int height_ = 1;
  std::vector<float> depth_;  // m; 0: nothing
};

std::uint32_t ColorOf(PosedModel::Verdict verdict) {
  switch (verdict) {
    case PosedModel::Verdict::kRight:
      return 0x30d060;
    case PosedModel::Verdict::kWrong:
      return 0xff4040;
    case PosedModel::Verdict::kLost:
      return 0xffd020;
  }
  return 0;
}

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

// As Markdown.
void PrintTable(std::vector<std::vector<std::string>> table) {
  std::vector<std::string> rule(table.front().size(), "---:");
  rule.front() = "---";
  table.insert(table.begin() + 1, rule);
  for (const auto& row : table) std::cout << "| " << absl::StrJoin(row, " | ") << " |\n";
}

absl::Status WriteReport(const EvalArguments& arguments, const FramesCatalogue& catalogue,
                         const std::vector<FrameResult>& results) {
  if (arguments.out.empty()) return absl::OkStatus();
  const std::filesystem::path folder(arguments.out);
  RETURN_IF_ERROR(WriteFramesReport(folder, arguments.command, catalogue.object_ids(), results));
  std::cout << "report: " << (folder / "report.json").string()
            << ", with a picture of each frame beside it\n";
  const absl::Status made = MakeReportPage(folder);
  if (!made.ok()) std::cerr << "graspdb: " << made.message() << "\n";
  return absl::OkStatus();
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
  PrintTable(StageTable(results));
  return WriteReport(arguments, **catalogue, results);
}

pictures::ShadedPicture DrawFrame(const FrameResult& result, const recognition::Points& scan) {
  const Image image(scan);
  pictures::ShadedPicture out{.caption = absl::StrFormat("%s  %.0f ms  %s", result.frame->name,
                                                         result.milliseconds, result.error),
                              .width = kWidth,
                              .height = image.height(),
                              .brightness = image.Brightness()};
  for (const PosedModel& posed : result.posed) {
    const recognition::VisibleSurface visible(posed.model->fine, posed.sensor_object.cast<float>());
    for (std::size_t k = 0; k < visible.points().size(); k += kDrawnStride) {
      const auto at = image.PixelOf(visible.At(visible.points()[k]));
      if (at) out.marks.push_back({*at, ColorOf(posed.verdict)});
    }
  }
  return out;
}

}  // namespace graspdb::lab
