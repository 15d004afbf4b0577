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

// Depth of objects within objects, and maximum number of recognitions for one cluster.
constexpr int kDepth = 3;
constexpr int kMaxRecognitions = 24;
// Voxels of all recognitions for one cluster together: 24 of 20,000 voxels, which few parts of 0.3
// m have. Doubled, a scan of noise takes as much longer.
constexpr std::size_t kMaxVoxels = 480'000;
// Where every score is accepted (minScore 0), an answer that is mostly wrong splits nothing.
constexpr double kKnown = 0.1;
// One object of several needs a higher score than one alone: parts of unknown objects resemble
// known ones with scores up to 0.7, touching objects have 0.95 and more (ADR 12).
constexpr double kMinSplitConfidence = 0.9;
// Parts separated by gaps are accepted where their answers explain this share of all; with less, an
// object between them may have been left out.
constexpr double kNearlyAll = 0.9;
// Minimum score of an answer that a split begins with.
constexpr double kPromising = 0.02;
// Recognitions of the object that is taken first.
constexpr int kRounds = 2;
// Maximum distance of an object's own points from its model, in deviations, and its lower limit, m.
constexpr float kDeviations = 3;
constexpr float kFinestM = 0.0035F;
// Minimum gap between the pieces that a removed object leaves over, m, and in voxels.
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

  // Appends the objects of `whole` to `out`, where these are known; returns whether they are. Parts
  // separated by gaps are the answer where their answers explain more than any for the whole.
  absl::StatusOr<bool> TakeCluster(AnsweredSegment whole, Answers* out) {
    Answers separated;
    if (!Scores(whole.detection, kKnown) || LeavesPieces(whole.segment, whole.detection)) {
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
  // The same without gaps, with answers that score at least `min_score`.
  absl::StatusOr<bool> Take(AnsweredSegment whole, double min_score, int depth, Answers* out) {
    if (!Scores(whole.detection, min_score)) {
      // Halves of parts are not recognised: they improve no scene of touching objects.
      if (depth == kDepth) return TakeUnknown(std::move(whole), out);
      return false;
    }
    if (LeavesPieces(whole.segment, whole.detection)) {
      auto parted = depth > 0 ? TakeWith(whole.segment, whole.detection, depth, out) : false;
      if (!parted.ok() || *parted) return parted;
      whole.detection.touching = true;
    }
    out->push_back(std::move(whole));
    return true;
  }

  // Whether an answer for `count` voxels at `segment` can score as high as one object of several
  // needs.
  bool MayReachConfidence(const Segment& segment, std::size_t count) const {
    return MaxConfidence(count, NoiseAt(input_.segmentation, segment)) >= kMinSplitConfidence;
  }
  bool MayReachConfidence(const Segment& segment) const {
    return MayReachConfidence(segment, segment.cloud.points.size());
  }

  static bool Scores(const Detection& detection, double min_score) {
    return detection.view && detection.score >= min_score;
  }

  // Voxels that accepted answers explain.
  static double Explained(const Answers& answers) {
    double sum = 0;
    for (const auto& [segment, detection, seen] : answers) {
      if (!detection.view) continue;
      sum += detection.evidence.scan_explained * static_cast<double>(segment.cloud.points.size());
    }
    return sum;
  }

  // Appends the parts of `whole` that narrow gaps separate to `out`, known or not.
  absl::Status Separate(const Segment& whole, Answers* out) {
    for (Segment& part : SplitAtGaps({input_.scan, input_.segmentation, whole}, voxel_size_,
                                     min_count_, is_cancelled_)) {
      auto answer = RecognizeWithinLimits(part);
      if (!answer.ok()) return answer.status();
      AnsweredSegment alone{std::move(part), *std::move(answer)};
      auto known = Take(alone, kKnown, kDepth - 1, out);
      if (!known.ok()) return known.status();
      if (!*known) out->push_back(std::move(alone));
    }
    for (AnsweredSegment& answer : *out) answer.detection.touching = true;
    return absl::OkStatus();
  }

  // For a `whole` without an answer as one object. The object that it resembles may still be its
  // greater part.
  absl::StatusOr<bool> TakeUnknown(AnsweredSegment whole, Answers* out) {
    // The smaller of two parts has half of the voxels at the most.
    const std::size_t half = whole.segment.cloud.points.size() / 2;
    if (half < min_count_ || IsAtLimit() || !MayReachConfidence(whole.segment, half)) return false;
    auto initial_answers = Halves(whole.segment);
    if (!initial_answers.ok()) return initial_answers.status();
    initial_answers->push_back(std::move(whole.detection));
    std::ranges::stable_sort(*initial_answers, std::greater(), &Detection::score);
    for (Detection& initial : *initial_answers) {
      if (initial.model == nullptr || initial.score < kPromising) continue;
      auto known = TakeWith(whole.segment, std::move(initial), kDepth, out);
      if (!known.ok() || *known) return known;
    }
    return false;
  }

  // `initial` is an answer for a part of `whole`.
  absl::StatusOr<bool> TakeWith(const Segment& whole, Detection initial, int depth, Answers* out) {
    AnsweredSegment object{{}, std::move(initial)};
    std::vector<Segment> rest;
    // The answer for a half does not explain all of the object, which is recognised once more.
    for (int round = 0; round < kRounds; ++round) {
      object.segment = PartOf(input_.scan, input_.segmentation, whole,
                              Within(object.detection, OwnM(object.detection)), is_cancelled_);
      // Segments that will be rejected for their size are not recognised.
      if (object.segment.cloud.points.size() < min_count_ || !MayReachConfidence(object.segment)) {
        return false;
      }
      const bool is_last = round + 1 == kRounds;
      if (!is_last && !LeavesPieces(whole, object.detection)) return false;
      if (is_last) {
        rest = LeftOver(whole, object.detection);
        if (rest.empty() ||
            !std::ranges::all_of(rest, [&](const Segment& s) { return MayReachConfidence(s); })) {
          return false;
        }
      }
      auto again = RecognizeWithinLimits(object.segment);
      if (!again.ok()) return again.status();
      if (!Scores(*again, kMinSplitConfidence)) return false;
      object.detection = *std::move(again);
    }
    const std::size_t before = out->size();
    out->push_back(std::move(object));
    for (Segment& piece : rest) {
      auto answer = RecognizeWithinLimits(piece);
      if (!answer.ok()) return answer.status();
      auto known =
          Take({std::move(piece), *std::move(answer)}, kMinSplitConfidence, depth - 1, out);
      if (known.ok() && *known) continue;
      out->erase(out->begin() + static_cast<std::ptrdiff_t>(before), out->end());
      return known;
    }
    for (std::size_t i = before; i < out->size(); ++i) (*out)[i].detection.touching = true;
    return true;
  }

  // Unknown once the cluster has reached its limits.
  absl::StatusOr<Detection> RecognizeWithinLimits(const Segment& segment) {
    if (IsAtLimit()) {
      Detection unknown;
      unknown.point_count = segment.cloud.points.size();
      unknown.centroid = segment.centroid;
      return unknown;
    }
    ++recognitions_;
    recognized_voxels_ += segment.cloud.points.size();
    return recognize_(segment);
  }

  bool IsAtLimit() const {
    return recognitions_ >= kMaxRecognitions || recognized_voxels_ >= kMaxVoxels;
  }

  // The answers for both halves of `whole`.
  absl::StatusOr<std::vector<Detection>> Halves(const Segment& whole) {
    const std::vector<Segment> halves =
        SplitInHalves({input_.scan, input_.segmentation, whole}, is_cancelled_);
    std::vector<absl::StatusOr<Detection>> answers(halves.size(), Detection());
    recognitions_ += static_cast<int>(halves.size());
    recognized_voxels_ += whole.cloud.points.size();
    ForEachIndex(halves.size(), [&](std::size_t i) {
      // Only an initial answer: not worth a long search.
      if (halves[i].cloud.points.size() >= min_count_) answers[i] = glance_(halves[i]);
    });
    std::vector<Detection> out;
    for (auto& answer : answers) {
      if (!answer.ok()) return answer.status();
      out.push_back(*std::move(answer));
    }
    return out;
  }

  // Distance of an object's own points from its model, m; points between that and the support
  // distance belong to either.
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

  // Whether LeftOver has any, which is sooner known.
  bool LeavesPieces(const Segment& whole, const Detection& answer) const {
    const IsPartOf is_its = Within(answer, support_);
    Points rest;
    std::ranges::remove_copy_if(whole.cloud.points, std::back_inserter(rest), is_its);
    return rest.size() >= min_count_ &&
           !FindClusters(rest, piece_gap_, min_count_, is_cancelled_).empty();
  }

  // Connected pieces, without those smaller than an object.
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
  int recognitions_ = 0;
  std::size_t recognized_voxels_ = 0;
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
  if (is_cancelled()) return absl::CancelledError("cancelled while splitting touching objects");
  if (!*known) out.push_back({whole.segment, std::move(answer)});
  return out;
}

}  // namespace graspdb::recognition
