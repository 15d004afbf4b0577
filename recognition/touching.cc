#include "recognition/touching.h"

#include <algorithm>
#include <array>
#include <functional>
#include <iterator>
#include <utility>

#include "recognition/clusters.h"
#include "recognition/point_search.h"

namespace graspdb::recognition {
namespace {

// Things in one cluster, at most.
constexpr int kMostThings = 4;
// A half that is explained worse than this is no beginning.
constexpr double kPromising = 0.02;
// How often the thing that was taken first is asked about anew.
constexpr int kRounds = 2;
// Steps in which the middles of two halves settle.
constexpr int kSettling = 8;
// A thing's own points are so many deviations from its model, and at least this far, m.
constexpr float kDeviations = 3;
constexpr float kFinestM = 0.0035F;
// What the peeled thing leaves behind is one piece unless gaps are wider than this, m.
constexpr double kPieceGapM = 0.01;

using Answers = std::vector<AnsweredSegment>;
using IsMine = std::function<bool(const Eigen::Vector3f& world)>;

// The part of `whole` whose points are mine.
Segment Part(const MatchingInput& input, const Segment& whole, const IsMine& is_mine) {
  Segment out;
  for (std::size_t i = 0; i < whole.cloud.points.size(); ++i) {
    if (!is_mine(whole.cloud.points[i])) continue;
    out.cloud.points.push_back(whole.cloud.points[i]);
    out.cloud.normals.push_back(whole.cloud.normals[i]);
  }
  const Eigen::Isometry3f world_sensor = input.segmentation.world_sensor.cast<float>();
  for (const std::int32_t i : whole.indices) {
    if (is_mine(world_sensor * input.scan.points[static_cast<std::size_t>(i)])) {
      out.indices.push_back(i);
    }
  }
  out.centroid = Centroid(out.cloud.points);
  return out;
}

// Two points over the table, one in the middle of either half (k-means, from the ends).
std::array<Eigen::Vector2f, 2> MiddlesOfHalves(const Points& points) {
  std::array<Eigen::Vector2f, 2> middles = {points.front().head<2>(), points.front().head<2>()};
  // The point farthest from any is one end, the farthest from that the other.
  for (const int end : {0, 1, 0}) {
    const Eigen::Vector2f from = middles[static_cast<std::size_t>(1 - end)];
    middles[static_cast<std::size_t>(end)] =
        std::ranges::max_element(points, {}, [&](const Eigen::Vector3f& p) {
          return (p.head<2>() - from).squaredNorm();
        })->head<2>();
  }
  for (int step = 0; step < kSettling; ++step) {
    std::array<Eigen::Vector2f, 2> sums = {Eigen::Vector2f::Zero(), Eigen::Vector2f::Zero()};
    std::array<float, 2> counts = {};
    for (const Eigen::Vector3f& p : points) {
      const std::size_t half =
          (p.head<2>() - middles[1]).squaredNorm() < (p.head<2>() - middles[0]).squaredNorm();
      sums[half] += p.head<2>();
      ++counts[half];
    }
    for (const std::size_t half : {0U, 1U}) {
      if (counts[half] > 0) middles[half] = sums[half] / counts[half];
    }
  }
  return middles;
}

class Parter {
 public:
  Parter(const MatchingInput& input, std::size_t min_count, double support_distance_m,
         const RecognizeAlone& recognize)
      : input_(input),
        min_count_(min_count),
        support_(static_cast<float>(support_distance_m)),
        recognize_(recognize) {}

  // Puts what `whole` consists of behind `out` where all of it is known; says whether it is.
  // `beginning` is an answer for a part of it.
  absl::StatusOr<bool> Take(const Segment& whole, Detection beginning, int most, Answers* out) {
    AnsweredSegment thing{{}, std::move(beginning)};
    std::vector<Segment> rest;
    // What a half explains is not all of the thing: it is asked about once more.
    for (int round = 0; round < kRounds; ++round) {
      thing.segment = Part(input_, whole, Within(thing.detection, OwnM(thing.detection)));
      rest = LeftOver(whole, thing.detection);
      if (thing.segment.cloud.points.size() < min_count_ || rest.empty()) return false;
      auto again = recognize_(thing.segment);
      if (!again.ok()) return again.status();
      if (!again->view) return false;
      thing.detection = *std::move(again);
    }
    const std::size_t before = out->size();
    out->push_back(std::move(thing));
    for (Segment& piece : rest) {
      auto answer = recognize_(piece);
      if (!answer.ok()) return answer.status();
      auto known = TakeAll({std::move(piece), *std::move(answer)}, most - 1, out);
      if (known.ok() && *known) continue;
      out->resize(before);
      return known;
    }
    return true;
  }

  // The same of what has an answer of its own, or must be begun with one of its halves.
  absl::StatusOr<bool> TakeAll(AnsweredSegment whole, int most, Answers* out) {
    if (whole.detection.view) {
      out->push_back(std::move(whole));
      return true;
    }
    if (most < 2 || whole.segment.cloud.points.size() < 2 * min_count_) return false;
    auto beginnings = Halves(whole.segment);
    if (!beginnings.ok()) return beginnings.status();
    // The whole may fail to be a thing by what touches it.
    beginnings->push_back(std::move(whole.detection));
    std::ranges::stable_sort(*beginnings, std::greater(), &Detection::score);
    for (Detection& beginning : *beginnings) {
      if (beginning.model == nullptr || beginning.score < kPromising) continue;
      auto known = Take(whole.segment, std::move(beginning), most, out);
      if (!known.ok() || *known) return known;
    }
    return false;
  }

  // Whether `answer` leaves over what may be a thing.
  bool LeavesSomething(const Segment& whole, const Detection& answer) const {
    return !LeftOver(whole, answer).empty();
  }

 private:
  // The answers for both halves of `whole`.
  absl::StatusOr<std::vector<Detection>> Halves(const Segment& whole) {
    const auto middles = MiddlesOfHalves(whole.cloud.points);
    std::vector<Detection> out;
    for (const bool second : {false, true}) {
      const Segment half = Part(input_, whole, [&](const Eigen::Vector3f& p) {
        return second == ((p.head<2>() - middles[1]).squaredNorm() <
                          (p.head<2>() - middles[0]).squaredNorm());
      });
      if (half.cloud.points.size() < min_count_) continue;
      auto answer = recognize_(half);
      if (!answer.ok()) return answer.status();
      out.push_back(*std::move(answer));
    }
    return out;
  }

  // How far from its model a thing's own points are, m; between that and the support distance they
  // are of either.
  float OwnM(const Detection& detection) const {
    return std::clamp(kDeviations * static_cast<float>(detection.evidence.rms_m),
                      std::min(kFinestM, support_), support_);
  }

  static IsMine Within(const Detection& detection, float distance_m) {
    return
        [model = detection.model, distance_m,
         object_world = Eigen::Isometry3f(detection.refined_pose.inverse().cast<float>())](
            const Eigen::Vector3f& p) { return model->DistanceTo(object_world * p) < distance_m; };
  }

  std::vector<Segment> LeftOver(const Segment& whole, const Detection& answer) const {
    const IsMine is_its = Within(answer, support_);
    return Pieces(Part(input_, whole, [&](const Eigen::Vector3f& p) { return !is_its(p); }));
  }

  // What hangs together; smaller than a thing is left out.
  std::vector<Segment> Pieces(const Segment& rest) const {
    std::vector<Segment> out;
    if (rest.cloud.points.size() < min_count_) return out;
    const PointSearch search(rest.cloud.points);
    for (const Indices& piece : FindClusters(rest.cloud.points, search, kPieceGapM, min_count_)) {
      Points points;
      points.reserve(piece.size());
      for (const std::int32_t i : piece) {
        points.push_back(rest.cloud.points[static_cast<std::size_t>(i)]);
      }
      const PointSearch near(points);
      out.push_back(Part(input_, rest, [&](const Eigen::Vector3f& p) {
        return near.Nearest(p).squared_distance < static_cast<float>(kPieceGapM * kPieceGapM) / 4;
      }));
    }
    return out;
  }

  const MatchingInput& input_;
  const std::size_t min_count_;
  const float support_;
  const RecognizeAlone& recognize_;
};

}  // namespace

absl::StatusOr<Answers> PartTouching(const MatchingInput& whole, Detection answer,
                                     std::size_t min_count, double support_distance_m,
                                     const RecognizeAlone& recognize) {
  Parter parter(whole, min_count, support_distance_m, recognize);
  const bool touches = answer.view && parter.LeavesSomething(whole.segment, answer);
  if (answer.view && !touches) return Answers{{whole.segment, std::move(answer)}};
  Answers out;
  const auto parted = answer.view ? parter.Take(whole.segment, answer, kMostThings, &out)
                                  : parter.TakeAll({whole.segment, answer}, kMostThings, &out);
  if (!parted.ok()) return parted.status();
  if (!*parted) out = {{whole.segment, std::move(answer)}};
  for (AnsweredSegment& thing : out) thing.detection.touching = *parted || touches;
  return out;
}

}  // namespace graspdb::recognition
