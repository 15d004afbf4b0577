#include "recognition/splitting/cluster_splitter.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <utility>

#include "absl/status/status.h"
#include "recognition/base/idle_cores.h"
#include "recognition/points/point_search.h"
#include "recognition/segmentation/clusters.h"
#include "recognition/segmentation/segment_part.h"
#include "recognition/splitting/gaps.h"
#include "recognition/splitting/halves.h"

namespace graspdb::recognition {
namespace {

// Objects within objects that are looked for, and how often one cluster is asked about in all.
constexpr int kDepth = 3;
constexpr int kMaxQuestions = 24;
// Voxels of all questions about one cluster together: 24 questions about 20,000 voxels, which few
// parts of 0.3 m have. Doubled, a scan of noise takes as much longer.
constexpr std::size_t kMaxVoxels = 480'000;
// Where no score is too low for an answer (minScore 0), one that is mostly wrong parts nothing.
constexpr double kKnown = 0.1;
// An object that is one of several must be surer than one alone: parts of what was never taught
// resemble something with scores up to 0.7, objects that touch have 0.95 and more (ADR 12).
constexpr double kSure = 0.9;
// Parts that gaps separate and whose answers explain this share of all are not doubted; with less
// something between them may have been left out.
constexpr double kNearlyAll = 0.9;
// A half that is explained worse than this is no beginning.
constexpr double kPromising = 0.02;
// How often the object that was taken first is asked about anew.
constexpr int kRounds = 2;
// An object's own points are so many deviations from its model, and at least this far, m.
constexpr float kDeviations = 3;
constexpr float kFinestM = 0.0035F;
// What an object that is taken away leaves behind is one piece unless gaps are wider than this, m,
// and than so many voxels.
constexpr double kPieceGapM = 0.01;
constexpr double kPieceGapVoxels = 3.3;

using Answers = std::vector<AnsweredSegment>;

class ClusterSplitter {
 public:
  ClusterSplitter(const MatchingInput& input, const SplittingOptions& options,
                  const RecognizeAlone& recognize, const RecognizeAlone& glance,
                  const IsCancelled& is_cancelled)
      : input_(input),
        min_count_(options.min_count),
        support_(static_cast<float>(options.support_distance_m)),
        voxel_size_(options.voxel_size_m),
        piece_gap_(std::max(kPieceGapM, kPieceGapVoxels * options.voxel_size_m)),
        recognize_(recognize),
        glance_(glance),
        is_cancelled_(is_cancelled) {}

  // Puts what `whole` consists of behind `out`, where that is known; says whether it is. Parts that
  // gaps separate are the answer where theirs explain more than any for the whole.
  absl::StatusOr<bool> TakeCluster(AnsweredSegment whole, Answers* out) {
    Answers separated;
    if (!Scores(whole.detection, kKnown) || !LeftOver(whole.segment, whole.detection).empty()) {
      absl::Status status = Separate(whole.segment, &separated);
      if (!status.ok()) return status;
    }
    const double explained = Explained(separated);
    Answers together;
    absl::StatusOr<bool> known = false;
    if (explained < kNearlyAll * static_cast<double>(whole.segment.cloud.points.size())) {
      known = Take(std::move(whole), kKnown, kDepth, &together);
      if (!known.ok()) return known;
    }
    const bool is_separated = explained > Explained(together);
    std::ranges::move(is_separated ? separated : together, std::back_inserter(*out));
    return is_separated || *known;
  }

 private:
  // The same without gaps. An answer that is not as sure as `least` is none.
  absl::StatusOr<bool> Take(AnsweredSegment whole, double least, int depth, Answers* out) {
    if (!Scores(whole.detection, least)) {
      // Halves of parts are not asked about: in no scene of objects that touch do they say more.
      if (depth == kDepth) return TakeUnknown(std::move(whole), out);
      return false;
    }
    if (!LeftOver(whole.segment, whole.detection).empty()) {
      auto parted = depth > 0 ? TakeWith(whole.segment, whole.detection, depth, out) : false;
      if (!parted.ok() || *parted) return parted;
      whole.detection.touching = true;
    }
    out->push_back(std::move(whole));
    return true;
  }

  // Whether an answer for `count` voxels at `segment` can be as sure as that of one object of
  // several.
  bool MayBeSure(const Segment& segment, std::size_t count) const {
    return MaxConfidence(count, NoiseAt(input_.segmentation, segment)) >= kSure;
  }
  bool MayBeSure(const Segment& segment) const {
    return MayBeSure(segment, segment.cloud.points.size());
  }

  static bool Scores(const Detection& detection, double least) {
    return detection.view && detection.score >= least;
  }

  // Voxels that answers which were not rejected explain.
  static double Explained(const Answers& answers) {
    double sum = 0;
    for (const auto& [segment, detection, seen] : answers) {
      if (!detection.view) continue;
      sum += detection.evidence.scan_explained * static_cast<double>(segment.cloud.points.size());
    }
    return sum;
  }

  // Puts the parts of `whole` that narrow gaps separate behind `out`, known or not.
  absl::Status Separate(const Segment& whole, Answers* out) {
    for (Segment& part : SplitAtGaps({input_.scan, input_.segmentation, whole}, voxel_size_,
                                     min_count_, is_cancelled_)) {
      auto answer = Ask(part);
      if (!answer.ok()) return answer.status();
      AnsweredSegment alone{std::move(part), *std::move(answer)};
      auto known = Take(alone, kKnown, kDepth - 1, out);
      if (!known.ok()) return known.status();
      if (!*known) out->push_back(std::move(alone));
    }
    for (AnsweredSegment& answer : *out) answer.detection.touching = true;
    return absl::OkStatus();
  }

  // Where `whole` as one object has no answer. What it is like may still be the greater part of it.
  absl::StatusOr<bool> TakeUnknown(AnsweredSegment whole, Answers* out) {
    // The smaller of two parts has half of the voxels at the most.
    const std::size_t half = whole.segment.cloud.points.size() / 2;
    if (half < min_count_ || IsAskedEnough() || !MayBeSure(whole.segment, half)) return false;
    auto beginnings = Halves(whole.segment);
    if (!beginnings.ok()) return beginnings.status();
    beginnings->push_back(std::move(whole.detection));
    std::ranges::stable_sort(*beginnings, std::greater(), &Detection::score);
    for (Detection& beginning : *beginnings) {
      if (beginning.model == nullptr || beginning.score < kPromising) continue;
      auto known = TakeWith(whole.segment, std::move(beginning), kDepth, out);
      if (!known.ok() || *known) return known;
    }
    return false;
  }

  // `beginning` is an answer for a part of `whole`.
  absl::StatusOr<bool> TakeWith(const Segment& whole, Detection beginning, int depth,
                                Answers* out) {
    AnsweredSegment object{{}, std::move(beginning)};
    std::vector<Segment> rest;
    // What a half explains is not all of the object: it is asked about once more.
    for (int round = 0; round < kRounds; ++round) {
      object.segment = PartOf(input_.scan, input_.segmentation, whole,
                              Within(object.detection, OwnM(object.detection)), is_cancelled_);
      rest = LeftOver(whole, object.detection);
      if (object.segment.cloud.points.size() < min_count_ || rest.empty()) return false;
      // What will be rejected for its size is not asked about; `rest` is final in the last round
      // only.
      if (!MayBeSure(object.segment)) return false;
      const bool is_last = round + 1 == kRounds;
      if (is_last && !std::ranges::all_of(rest, [&](const Segment& s) { return MayBeSure(s); })) {
        return false;
      }
      auto again = Ask(object.segment);
      if (!again.ok()) return again.status();
      if (!Scores(*again, kSure)) return false;
      object.detection = *std::move(again);
    }
    const std::size_t before = out->size();
    out->push_back(std::move(object));
    for (Segment& piece : rest) {
      auto answer = Ask(piece);
      if (!answer.ok()) return answer.status();
      auto known = Take({std::move(piece), *std::move(answer)}, kSure, depth - 1, out);
      if (known.ok() && *known) continue;
      out->erase(out->begin() + static_cast<std::ptrdiff_t>(before), out->end());
      return known;
    }
    for (std::size_t i = before; i < out->size(); ++i) (*out)[i].detection.touching = true;
    return true;
  }

  // Nothing more is known of a cluster that was asked about too often.
  absl::StatusOr<Detection> Ask(const Segment& segment) {
    if (IsAskedEnough()) return Detection();
    ++questions_;
    asked_voxels_ += segment.cloud.points.size();
    return recognize_(segment);
  }

  bool IsAskedEnough() const { return questions_ >= kMaxQuestions || asked_voxels_ >= kMaxVoxels; }

  // The answers for both halves of `whole`.
  absl::StatusOr<std::vector<Detection>> Halves(const Segment& whole) {
    const std::vector<Segment> halves =
        SplitInHalves({input_.scan, input_.segmentation, whole}, is_cancelled_);
    std::vector<absl::StatusOr<Detection>> answers(halves.size(), Detection());
    questions_ += static_cast<int>(halves.size());
    asked_voxels_ += whole.cloud.points.size();
    ForEachIndex(halves.size(), [&](std::size_t i) {
      // It is only where to begin: not worth a long search.
      if (halves[i].cloud.points.size() >= min_count_) answers[i] = glance_(halves[i]);
    });
    std::vector<Detection> out;
    for (auto& answer : answers) {
      if (!answer.ok()) return answer.status();
      out.push_back(*std::move(answer));
    }
    return out;
  }

  // How far from its model an object's own points are, m; between that and the support distance
  // they are of either.
  float OwnM(const Detection& detection) const {
    return std::clamp(kDeviations * static_cast<float>(detection.evidence.rms_m),
                      std::min(kFinestM, support_), support_);
  }

  static IsPartOf Within(const Detection& detection, float distance_m) {
    return
        [model = detection.model, distance_m,
         object_world = Eigen::Isometry3f(detection.refined_pose.inverse().cast<float>())](
            const Eigen::Vector3f& p) { return model->DistanceTo(object_world * p) < distance_m; };
  }

  std::vector<Segment> LeftOver(const Segment& whole, const Detection& answer) const {
    const IsPartOf is_its = Within(answer, support_);
    return Pieces(PartOf(
        input_.scan, input_.segmentation, whole,
        [&](const Eigen::Vector3f& p) { return !is_its(p); }, is_cancelled_));
  }

  // What hangs together; smaller than an object is left out.
  std::vector<Segment> Pieces(const Segment& rest) const {
    std::vector<Segment> out;
    if (rest.cloud.points.size() < min_count_) return out;
    for (const Indices& piece :
         FindClusters(rest.cloud.points, piece_gap_, min_count_, is_cancelled_)) {
      if (is_cancelled_()) break;
      Points points;
      points.reserve(piece.size());
      for (const std::int32_t i : piece) {
        points.push_back(rest.cloud.points[static_cast<std::size_t>(i)]);
      }
      const PointSearch near(points);
      const IsPartOf is_near = [&](const Eigen::Vector3f& p) {
        return near.Nearest(p).squared_distance < static_cast<float>(piece_gap_ * piece_gap_) / 4;
      };
      out.push_back(PartOf(input_.scan, input_.segmentation, rest, is_near, is_cancelled_));
    }
    return out;
  }

  const MatchingInput& input_;
  const std::size_t min_count_;
  const float support_;
  const double voxel_size_;
  const double piece_gap_;
  const RecognizeAlone& recognize_;
  const RecognizeAlone& glance_;
  const IsCancelled& is_cancelled_;
  int questions_ = 0;
  std::size_t asked_voxels_ = 0;
};

}  // namespace

absl::StatusOr<Answers> PartTouching(const MatchingInput& whole, Detection answer,
                                     const SplittingOptions& options,
                                     const RecognizeAlone& recognize, const RecognizeAlone& glance,
                                     const IsCancelled& is_cancelled) {
  Answers out;
  const auto known = ClusterSplitter(whole, options, recognize, glance, is_cancelled)
                         .TakeCluster({whole.segment, answer}, &out);
  if (!known.ok()) return known.status();
  if (is_cancelled()) return absl::CancelledError("cancelled while what touches was parted");
  if (!*known) out.push_back({whole.segment, std::move(answer)});
  return out;
}

}  // namespace graspdb::recognition
