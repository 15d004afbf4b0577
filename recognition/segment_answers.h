// Recognises the segments of one scan.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "recognition/answered_segment.h"
#include "recognition/base/search_budget.h"
#include "recognition/base/stages.h"
#include "recognition/segment_recognition.h"
#include "recognition/segmentation/unions.h"
#include "recognition/verification/scan_depths.h"

namespace graspdb::recognition {

// Processes segments in parallel on idle cores. For one thread; all references must outlive it.
class SegmentAnswers {
 public:
  SegmentAnswers(const Scan& scan, const Segmentation& segmentation,
                 const CatalogueSnapshot& catalogue, ViewClouds& clouds,
                 const RecognitionParameters& parameters, const IsCancelled& is_cancelled);

  // Call once. Calls `beside` once, where the last segments leave cores idle. CANCELLED; errors of
  // LoadModel.
  absl::StatusOr<std::vector<AnsweredSegment>> Take(const std::function<void()>& beside);

  // Adds the stages and the untried views.
  void Report(StageLog* log, Recognition* out) const;

 private:
  using Answers = std::vector<AnsweredSegment>;

  // Of one segment; of one thread at a time.
  struct Work {
    StageLog log;
    SearchBudget budget;
    std::shared_ptr<SegmentRecognition> search;  // that has not ended
  };

  Work& WorkOn(const AnsweredSegment& answer);
  static absl::Status ForEach(Answers* answers,
                              const std::function<absl::Status(AnsweredSegment*)>& job,
                              const std::function<void()>& last_job);
  absl::Status TryNearest(AnsweredSegment* answer);
  absl::Status Answer(AnsweredSegment* answer);
  absl::Status JoinPieces(Answers* answers);
  absl::StatusOr<AnsweredSegment> TryUnion(const Segment& a, const Segment& b, StageLog* log);
  void ShareBudget(const Answers& answers);
  bool IsTouching(const AnsweredSegment& answer) const;
  std::shared_ptr<SegmentRecognition> SearchIn(const Segment& segment, StageLog* log);

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

}  // namespace graspdb::recognition
