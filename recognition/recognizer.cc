#include "recognition/recognizer.h"

#include <algorithm>
#include <chrono>
#include <functional>
#include <iterator>
#include <memory>
#include <mutex>

#include "absl/status/status.h"
#include "recognition/fragments.h"
#include "recognition/idle_cores.h"
#include "recognition/segment_recognition.h"
#include "recognition/touching.h"

namespace graspdb::recognition {
namespace {

using Answers = std::vector<AnsweredSegment>;

// Searches that are kept while other segments are recognised; a megabyte each, mostly.
constexpr std::size_t kMaxOpenSearches = 32;

// Recognises the segments of one scan, several at once where cores are idle.
class SegmentAnswers {
 public:
  SegmentAnswers(const Scan& scan, const Segmentation& segmentation,
                 const CatalogueSnapshot& catalogue, ViewClouds& clouds,
                 const RecognitionParameters& parameters, const IsCancelled& is_cancelled)
      : scan_(scan),
        segmentation_(segmentation),
        depths_(scan, segmentation.segments),
        catalogue_(catalogue),
        clouds_(clouds),
        parameters_(parameters),
        is_cancelled_(is_cancelled),
        budget_(static_cast<std::size_t>(parameters.matching.further_view_budget),
                std::chrono::duration<double>(parameters.matching.search_ceiling_s)),
        work_(segmentation.segments.size(), Work{{}, budget_, {}, {}}) {}

  absl::StatusOr<Answers> Take() {
    Answers answers;
    for (const Segment& segment : segmentation_.segments)
      answers.push_back({segment, {}, &segment});
    absl::Status status = ForEach(&answers, [this](AnsweredSegment* a) { return TryNearest(a); });
    if (!status.ok()) return status;
    JoinFragments(parameters_.matching.support_distance_m, &answers);
    ShareBudget(answers);
    status = ForEach(&answers, [this](AnsweredSegment* a) { return Finish(a); });
    if (!status.ok()) return status;
    Answers out;
    for (const AnsweredSegment& answer : answers) {
      std::ranges::move(WorkOn(answer).parts, std::back_inserter(out));
    }
    JoinFragments(parameters_.matching.support_distance_m, &out);
    return out;
  }

  // What was done, and what was not.
  void Report(StageLog* log, Recognition* out) const {
    for (const Work& work : work_) {
      log->Add(work.log);
      out->untried_view_count += work.budget.untried();
      out->out_of_time = out->out_of_time || work.budget.out_of_time();
    }
  }

 private:
  // Of one segment; of one thread at a time.
  struct Work {
    StageLog log;
    SearchBudget budget;
    std::shared_ptr<SegmentRecognition> search;  // that has not ended
    Answers parts;
  };

  Work& WorkOn(const AnsweredSegment& answer) {
    return work_[static_cast<std::size_t>(answer.seen - segmentation_.segments.data())];
  }

  static absl::Status ForEach(Answers* answers,
                              const std::function<absl::Status(AnsweredSegment*)>& job) {
    std::vector<AnsweredSegment*> order;
    for (AnsweredSegment& answer : *answers) order.push_back(&answer);
    // The largest first: what is begun last leaves cores idle for its time.
    std::ranges::stable_sort(order, std::greater(), [](const AnsweredSegment* answer) {
      return answer->segment.cloud.points.size();
    });
    std::vector<absl::Status> done(answers->size());
    ForEachIndex(order.size(), [&](std::size_t i) { done[i] = job(order[i]); });
    const auto failed = std::ranges::find_if(done, [](const auto& status) { return !status.ok(); });
    return failed == done.end() ? absl::OkStatus() : *failed;
  }

  // Those that the nearest views explain are answered first. What lies on one of them is a piece of
  // it, which needs no search of its own: it would be long, for a descriptor of a piece says
  // little.
  absl::Status TryNearest(AnsweredSegment* answer) {
    Work& work = WorkOn(*answer);
    auto search = SearchIn(*answer->seen, &work.log);
    const absl::StatusOr<bool> explained = search->TryNearest();
    if (!explained.ok()) return explained.status();
    if (&work - work_.data() < static_cast<std::ptrdiff_t>(kMaxOpenSearches) || *explained) {
      work.search = std::move(search);
    }
    return *explained ? Answer(answer) : absl::OkStatus();
  }

  absl::Status Answer(AnsweredSegment* answer) {
    Work& work = WorkOn(*answer);
    if (!work.search) work.search = SearchIn(*answer->seen, &work.log);
    absl::StatusOr<Detection> detection = work.search->Answer(work.budget);
    work.search = nullptr;
    if (!detection.ok()) return detection.status();
    answer->detection = *std::move(detection);
    return absl::OkStatus();
  }

  // What nothing explains yet has all of it in equal shares; for what touches something that is
  // explained there are shares of the same size.
  void ShareBudget(const Answers& answers) {
    const auto open = std::ranges::count_if(
        answers, [](const AnsweredSegment& a) { return a.detection.model == nullptr; });
    for (Work& work : work_) work.budget = budget_.Share(static_cast<std::size_t>(open));
  }

  absl::Status Finish(AnsweredSegment* answer) {
    if (answer->detection.model == nullptr) {
      if (absl::Status status = Answer(answer); !status.ok()) return status;
    }
    Work& work = WorkOn(*answer);
    auto parts = Part(std::move(*answer), &work);
    if (!parts.ok()) return parts.status();
    work.parts = *std::move(parts);
    return absl::OkStatus();
  }

  // What the camera saw as one may be several things.
  absl::StatusOr<Answers> Part(AnsweredSegment answer, Work* work) {
    // A scan of one thing alone is that, whatever it looks like.
    if (parameters_.matching.verified_view_count <= 1 || scan_.segmented) return Answers{answer};
    const PartingOptions options{
        .min_count = static_cast<std::size_t>(parameters_.segmentation.min_cluster_point_count),
        .support_distance_m = parameters_.matching.support_distance_m,
        .voxel_size_m = parameters_.descriptor.voxel_size_m};
    const auto recognize = [&](const Segment& s) {
      return SearchIn(s, &work->log)->Answer(work->budget);
    };
    std::mutex mutex;
    const auto glance = [&](const Segment& s) {
      SearchBudget half = work->budget.ForHalf();
      StageLog log;
      auto half_answer = SearchIn(s, &log)->QuickAnswer(half);
      const std::lock_guard lock(mutex);
      work->log.Add(log);
      return half_answer;
    };
    return PartTouching({scan_, segmentation_, answer.segment}, std::move(answer.detection),
                        options, recognize, glance, is_cancelled_);
  }

  std::shared_ptr<SegmentRecognition> SearchIn(const Segment& segment, StageLog* log) {
    return std::make_shared<SegmentRecognition>(MatchingInput{scan_, segmentation_, segment},
                                                depths_, catalogue_, clouds_, parameters_,
                                                is_cancelled_, log);
  }

  const Scan& scan_;
  const Segmentation& segmentation_;
  const ScanDepths depths_;
  const CatalogueSnapshot& catalogue_;
  ViewClouds& clouds_;
  const RecognitionParameters& parameters_;
  const IsCancelled& is_cancelled_;
  const SearchBudget budget_;
  std::vector<Work> work_;  // of each segment
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
  SegmentAnswers recognition(scan, *segmentation, catalogue, clouds, parameters, is_cancelled);
  absl::StatusOr<Answers> answers = recognition.Take();
  if (!answers.ok()) return answers.status();
  const Eigen::Vector3d sensor = out.world_sensor.translation();
  std::ranges::stable_sort(*answers, {}, [&](const AnsweredSegment& answer) {
    return (answer.segment.centroid - sensor).squaredNorm();
  });
  for (AnsweredSegment& answer : *answers) out.detections.push_back(std::move(answer.detection));
  recognition.Report(&log, &out);
  out.stages = log.reports();
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
