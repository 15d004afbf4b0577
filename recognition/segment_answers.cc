#include "recognition/segment_answers.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "recognition/base/idle_cores.h"
#include "recognition/fragments.h"
#include "recognition/verification/confidence.h"

namespace graspdb::recognition {
namespace {

// Searches that are kept while other segments are recognised; a megabyte each, mostly.
constexpr std::size_t kMaxOpenSearches = 32;

// Pieces of one object are no farther apart than this, m: 30 mm are hidden behind a finger, or by a
// part's own edge that stands as high above its middle. Doubled, more pairs are neighbours.
constexpr double kMaxGapM = 0.03;
// Unions of two pieces that are tried for a frame, the nearest pairs; each takes as long as the
// nearest views of a segment.
constexpr std::size_t kMaxUnions = 6;
// A union with less confidence is rejected, since each piece may still be explained better on its
// own.
constexpr double kMinUnionConfidence = 0.9;

}  // namespace

SegmentAnswers::SegmentAnswers(const Scan& scan, const Segmentation& segmentation,
                               const CatalogueSnapshot& catalogue, ViewClouds& clouds,
                               const RecognitionParameters& parameters,
                               const IsCancelled& is_cancelled)
    : scan_(scan),
      segmentation_(segmentation),
      depths_(scan, segmentation.segments),
      catalogue_(catalogue),
      clouds_(clouds),
      parameters_(parameters),
      is_cancelled_(is_cancelled),
      budget_(static_cast<std::size_t>(parameters.matching.further_view_budget),
              std::chrono::duration<double>(parameters.matching.search_ceiling_s)),
      work_(segmentation.segments.size(), Work{{}, budget_, {}}) {}

absl::StatusOr<std::vector<AnsweredSegment>> SegmentAnswers::Take(
    const std::function<void()>& beside) {
  Answers answers;
  for (const Segment& segment : segmentation_.segments) answers.push_back({segment, {}, &segment});
  absl::Status status = ForEach(
      &answers, [this](AnsweredSegment* a) { return TryNearest(a); }, [] {});
  if (!status.ok()) return status;
  JoinFragments(parameters_.matching.support_distance_m, &answers);
  if (status = JoinPieces(&answers); !status.ok()) return status;
  ShareBudget(answers);
  status = ForEach(
      &answers,
      [this](AnsweredSegment* a) {
        absl::Status done = a->detection.model == nullptr ? Answer(a) : absl::OkStatus();
        if (done.ok()) a->detection.touching = IsTouching(*a);
        return done;
      },
      beside);
  if (!status.ok()) return status;
  JoinFragments(parameters_.matching.support_distance_m, &answers);
  return answers;
}

void SegmentAnswers::Report(StageLog* log, Recognition* out) const {
  for (const Work& work : work_) {
    log->Add(work.log);
    out->untried_view_count += work.budget.untried();
    out->out_of_time = out->out_of_time || work.budget.out_of_time();
  }
}

SegmentAnswers::Work& SegmentAnswers::WorkOn(const AnsweredSegment& answer) {
  return work_[static_cast<std::size_t>(answer.seen - segmentation_.segments.data())];
}

absl::Status SegmentAnswers::ForEach(Answers* answers,
                                     const std::function<absl::Status(AnsweredSegment*)>& job,
                                     const std::function<void()>& last_job) {
  std::vector<AnsweredSegment*> order;
  for (AnsweredSegment& answer : *answers) order.push_back(&answer);
  // The largest first: the job that begins last leaves cores idle for its time.
  std::ranges::stable_sort(order, std::greater(), [](const AnsweredSegment* answer) {
    return answer->segment.cloud.points.size();
  });
  std::vector<absl::Status> done(answers->size());
  ForEachIndex(order.size() + 1, [&](std::size_t i) {
    if (i == order.size()) return last_job();
    done[i] = job(order[i]);
  });
  const auto failed = std::ranges::find_if(done, [](const auto& status) { return !status.ok(); });
  return failed == done.end() ? absl::OkStatus() : *failed;
}

// Segments that the nearest views explain are answered first. A segment on one of them is a piece
// of it and needs no search of its own, which would be long since the descriptor of a piece is not
// distinctive.
absl::Status SegmentAnswers::TryNearest(AnsweredSegment* answer) {
  Work& work = WorkOn(*answer);
  auto search = SearchIn(*answer->seen, &work.log);
  const absl::StatusOr<bool> explained = search->TryNearest();
  if (!explained.ok()) return explained.status();
  if (&work - work_.data() < static_cast<std::ptrdiff_t>(kMaxOpenSearches) || *explained) {
    work.search = std::move(search);
  }
  return *explained ? Answer(answer) : absl::OkStatus();
}

absl::Status SegmentAnswers::Answer(AnsweredSegment* answer) {
  Work& work = WorkOn(*answer);
  if (!work.search) work.search = SearchIn(*answer->seen, &work.log);
  absl::StatusOr<Detection> detection = work.search->Answer(&work.budget);
  work.search = nullptr;
  if (!detection.ok()) return detection.status();
  answer->detection = *std::move(detection);
  return absl::OkStatus();
}

// Two unexplained neighbours may be pieces of one object, which its nearest views explain much
// sooner than further views explain the pieces.
absl::Status SegmentAnswers::JoinPieces(Answers* answers) {
  if (parameters_.matching.verified_view_count <= 1) return absl::OkStatus();
  std::vector<std::size_t> open;
  std::vector<const Segment*> segments;
  for (std::size_t i = 0; i < answers->size() && open.size() < kMaxOpenSearches; ++i) {
    if ((*answers)[i].detection.model != nullptr) continue;
    open.push_back(i);
    segments.push_back(&(*answers)[i].segment);
  }
  std::vector<SegmentPair> pairs =
      NeighbouringPairs(segments, kMaxGapM, parameters_.segmentation.max_object_size_m);
  pairs.resize(std::min(pairs.size(), kMaxUnions));
  std::vector<StageLog> logs(pairs.size());
  std::vector<absl::StatusOr<AnsweredSegment>> unions(pairs.size(), AnsweredSegment());
  ForEachIndex(pairs.size(), [&](std::size_t i) {
    unions[i] = TryUnion(*segments[pairs[i].first], *segments[pairs[i].second], &logs[i]);
  });
  std::vector<bool> is_joined(answers->size(), false);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (!unions[i].ok()) return unions[i].status();
    const std::size_t whole = open[pairs[i].first];
    const std::size_t piece = open[pairs[i].second];
    AnsweredSegment& answer = (*answers)[whole];
    WorkOn(answer).log.Add(logs[i]);
    const bool is_open = answer.detection.model == nullptr && !is_joined[whole] &&
                         (*answers)[piece].detection.model == nullptr && !is_joined[piece];
    if (!is_open || unions[i]->detection.model == nullptr) continue;
    answer.segment = std::move(unions[i]->segment);
    answer.detection = std::move(unions[i]->detection);
    is_joined[piece] = true;
  }
  std::erase_if(*answers, [&](const AnsweredSegment& answer) {
    return is_joined[static_cast<std::size_t>(&answer - answers->data())];
  });
  return absl::OkStatus();
}

// Without a model where the nearest views of both pieces together do not explain each of them.
absl::StatusOr<AnsweredSegment> SegmentAnswers::TryUnion(const Segment& a, const Segment& b,
                                                         StageLog* log) {
  AnsweredSegment out{.segment = UnionOf(a, b), .detection = {}};
  const double noise = NoiseAt(segmentation_, out.segment);
  if (MaxConfidence(out.segment.cloud.points.size(), noise) < kMinUnionConfidence) return out;
  absl::StatusOr<Detection> detection = SearchIn(out.segment, log)->Answer(nullptr);
  if (!detection.ok()) return detection.status();
  const double reach = parameters_.matching.support_distance_m;
  if (detection->view && detection->score >= kMinUnionConfidence && LiesOn(a, *detection, reach) &&
      LiesOn(b, *detection, reach)) {
    out.detection = *std::move(detection);
  }
  return out;
}

// Unexplained segments share all of it equally; segments that touch an explained object get shares
// of the same size.
void SegmentAnswers::ShareBudget(const Answers& answers) {
  const auto open = std::ranges::count_if(
      answers, [](const AnsweredSegment& a) { return a.detection.model == nullptr; });
  for (Work& work : work_) work.budget = budget_.Share(static_cast<std::size_t>(open));
}

bool SegmentAnswers::IsTouching(const AnsweredSegment& answer) const {
  if (answer.detection.view == nullptr || answer.detection.model == nullptr || scan_.segmented) {
    return false;
  }
  return LeavesPieces(
      answer, parameters_.matching.support_distance_m, parameters_.descriptor.voxel_size_m,
      static_cast<std::size_t>(parameters_.segmentation.min_cluster_point_count), is_cancelled_);
}

std::shared_ptr<SegmentRecognition> SegmentAnswers::SearchIn(const Segment& segment,
                                                             StageLog* log) {
  return std::make_shared<SegmentRecognition>(MatchingInput{scan_, segmentation_, segment}, depths_,
                                              catalogue_, clouds_, parameters_, is_cancelled_, log);
}

}  // namespace graspdb::recognition
