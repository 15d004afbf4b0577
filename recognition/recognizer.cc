#include "recognition/recognizer.h"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <memory>
#include <unordered_map>

#include "absl/status/status.h"
#include "recognition/fragments.h"
#include "recognition/segment_recognition.h"
#include "recognition/touching.h"

namespace graspdb::recognition {
namespace {

// What the camera saw as one may be several things.
absl::StatusOr<std::vector<AnsweredSegment>> Part(std::vector<AnsweredSegment> answers,
                                                  const Scan& scan,
                                                  const Segmentation& segmentation,
                                                  const RecognitionParameters& parameters,
                                                  const RecognizeAlone& recognize,
                                                  const RecognizeAlone& glance) {
  const PartingOptions options{
      .min_count = static_cast<std::size_t>(parameters.segmentation.min_cluster_point_count),
      .support_distance_m = parameters.matching.support_distance_m,
      .voxel_size_m = parameters.descriptor.voxel_size_m};
  std::vector<AnsweredSegment> out;
  out.reserve(answers.size());
  for (AnsweredSegment& answer : answers) {
    auto things = PartTouching({scan, segmentation, answer.segment}, std::move(answer.detection),
                               options, recognize, glance);
    if (!things.ok()) return things.status();
    std::ranges::move(*things, std::back_inserter(out));
  }
  return out;
}

// Searches that are kept while other segments are recognised; a megabyte each, mostly.
constexpr std::size_t kMaxOpenSearches = 32;

// Recognises the segments of one scan.
class SegmentAnswers {
 public:
  SegmentAnswers(const Scan& scan, const Segmentation& segmentation,
                 const CatalogueSnapshot& catalogue, ViewClouds& clouds,
                 const RecognitionParameters& parameters, const IsCancelled& is_cancelled,
                 StageLog* log)
      : scan_(scan),
        segmentation_(segmentation),
        depths_(scan, segmentation.segments),
        catalogue_(catalogue),
        clouds_(clouds),
        parameters_(parameters),
        is_cancelled_(is_cancelled),
        log_(log),
        budget_(static_cast<std::size_t>(parameters.matching.further_view_budget),
                std::chrono::duration<double>(parameters.matching.search_ceiling_s)) {}

  // One segment alone.
  absl::StatusOr<Detection> Answer(const Segment& segment) {
    return SearchIn(segment)->Answer(budget_);
  }

  // The same with few of the further views, for half of a cluster.
  absl::StatusOr<Detection> AnswerOfHalf(const Segment& segment) {
    SearchBudget half = budget_.ForHalf();
    return SearchIn(segment)->Answer(half);
  }

  // Those that the nearest views explain are answered first. What lies on one of them is a piece of
  // it, which needs no search of its own: it would be long, for a descriptor of a piece says
  // little.
  absl::StatusOr<std::vector<AnsweredSegment>> AnswerAll() {
    std::vector<AnsweredSegment> answers;
    std::unordered_map<const Segment*, std::unique_ptr<SegmentRecognition>> open;
    for (const Segment& segment : segmentation_.segments) {
      answers.push_back({segment, {}, &segment});
      std::unique_ptr<SegmentRecognition> search = SearchIn(segment);
      absl::StatusOr<bool> explained = search->TryNearest();
      if (explained.ok() && !*explained) {
        if (open.size() < kMaxOpenSearches) open[&segment] = std::move(search);
        continue;
      }
      absl::StatusOr<Detection> detection =
          explained.ok() ? search->Answer(budget_) : explained.status();
      if (!detection.ok()) return detection.status();
      answers.back().detection = *std::move(detection);
    }
    JoinFragments(parameters_.matching.support_distance_m, &answers);
    for (AnsweredSegment& answer : answers) {
      if (answer.detection.model != nullptr) continue;
      const auto known = open.find(answer.seen);
      absl::StatusOr<Detection> detection =
          known != open.end() ? known->second->Answer(budget_) : Answer(*answer.seen);
      if (!detection.ok()) return detection.status();
      answer.detection = *std::move(detection);
    }
    return answers;
  }

  const SearchBudget& budget() const { return budget_; }

 private:
  std::unique_ptr<SegmentRecognition> SearchIn(const Segment& segment) {
    return std::make_unique<SegmentRecognition>(MatchingInput{scan_, segmentation_, segment},
                                                depths_, catalogue_, clouds_, parameters_,
                                                is_cancelled_, log_);
  }

  const Scan& scan_;
  const Segmentation& segmentation_;
  const ScanDepths depths_;
  const CatalogueSnapshot& catalogue_;
  ViewClouds& clouds_;
  const RecognitionParameters& parameters_;
  const IsCancelled& is_cancelled_;
  StageLog* log_;
  SearchBudget budget_;
};

// The best that can be said of the frame as a whole.
RecognitionOutcome Summarize(const std::vector<Detection>& detections) {
  for (const Detection& d : detections) {
    if (d.outcome == RecognitionOutcome::kOk) return RecognitionOutcome::kOk;
  }
  return detections.front().outcome;
}

}  // namespace

absl::StatusOr<Recognition> Recognize(const Scan& scan, const CatalogueSnapshot& catalogue,
                                      ViewClouds& clouds, const RecognitionParameters& parameters,
                                      const IsCancelled& cancelled_by_caller) {
  const IsCancelled is_cancelled = Latched(cancelled_by_caller);
  StageLog log;
  absl::StatusOr<Segmentation> segmentation =
      SegmentScan(scan, parameters.segmentation, parameters.descriptor, is_cancelled, &log);
  if (!segmentation.ok()) return segmentation.status();

  Recognition out;
  out.revision = catalogue.revision;
  out.world_sensor = segmentation->world_sensor;
  out.world_frame = segmentation->world_frame;
  SegmentAnswers recognition(scan, *segmentation, catalogue, clouds, parameters, is_cancelled,
                             &log);
  auto all = recognition.AnswerAll();
  if (!all.ok()) return all.status();
  std::vector<AnsweredSegment> answers = *std::move(all);
  // A scan of one thing alone is that, whatever it looks like.
  if (parameters.matching.verified_view_count > 1 && !scan.segmented) {
    const auto recognize = [&](const Segment& s) { return recognition.Answer(s); };
    const auto glance = [&](const Segment& s) { return recognition.AnswerOfHalf(s); };
    auto things = Part(std::move(answers), scan, *segmentation, parameters, recognize, glance);
    if (!things.ok()) return things.status();
    answers = *std::move(things);
  }
  JoinFragments(parameters.matching.support_distance_m, &answers);
  const Eigen::Vector3d sensor = out.world_sensor.translation();
  std::ranges::stable_sort(answers, {}, [&](const AnsweredSegment& answer) {
    return (answer.segment.centroid - sensor).squaredNorm();
  });
  for (AnsweredSegment& answer : answers) out.detections.push_back(std::move(answer.detection));
  out.stages = log.reports();
  out.untried_view_count = recognition.budget().untried();
  out.out_of_time = recognition.budget().out_of_time();
  switch (segmentation->outcome) {
    case SegmentationOutcome::kEmptyRegion:
      out.outcome = RecognitionOutcome::kEmptyRegion;
      break;
    case SegmentationOutcome::kNoCluster:
      out.outcome = RecognitionOutcome::kNoCluster;
      break;
    case SegmentationOutcome::kFound:
      out.outcome = Summarize(out.detections);
      break;
  }
  return out;
}

}  // namespace graspdb::recognition
