#include "recognition/pairs/pair_votes.h"

#include <algorithm>
#include <numbers>

#include "recognition/simd/kernels.h"
#include "recognition/simd/soa_cloud.h"

namespace graspdb::recognition {
namespace {

// Bins of a whole turn, of 12 degrees.
constexpr std::size_t kTurnBins = 30;

struct Peak {
  std::uint32_t votes = 0;
  std::size_t point = 0;  // of the model
  std::size_t bin = 0;    // and the next one
};

// Votes of one scene point: for each model point that it may be, and each turn about its normal.
class Accumulator {
 public:
  explicit Accumulator(std::size_t points) : votes_(points * kTurnBins, 0) {}

  void Clear() { std::ranges::fill(votes_, 0); }
  void Add(std::size_t point, std::uint16_t turn) {
    votes_[point * kTurnBins + ((turn * kTurnBins) >> 16U)] += 1;
  }

  // The most votes in two bins side by side, of different model points.
  void FindPeaks(std::size_t count, std::vector<Peak>* out) const {
    out->clear();
    for (std::size_t point = 0; point * kTurnBins < votes_.size(); ++point) {
      Peak best;
      const std::uint16_t* bins = votes_.data() + point * kTurnBins;
      for (std::size_t b = 0; b < kTurnBins; ++b) {
        const std::uint32_t votes =
            static_cast<std::uint32_t>(bins[b]) + bins[b + 1 < kTurnBins ? b + 1 : 0];
        if (votes > best.votes) best = {votes, point, b};
      }
      if (best.votes < kMinVotes) continue;
      if (out->size() == count && best.votes <= out->back().votes) continue;
      if (out->size() == count) out->pop_back();
      out->insert(std::ranges::upper_bound(*out, best.votes, std::greater(), &Peak::votes), best);
    }
  }

 private:
  // Fewer agree by chance.
  static constexpr std::uint32_t kMinVotes = 4;

  std::vector<std::uint16_t> votes_;
};

// Puts the model's point and normal on the scene's, turned by `turn_rad` about it.
Eigen::Isometry3f PoseOf(const ReferenceFrame& scene, const ReferenceFrame& model, float turn_rad) {
  const Eigen::Matrix3f turn =
      Eigen::AngleAxisf(turn_rad, Eigen::Vector3f::UnitX()).toRotationMatrix();
  Eigen::Isometry3f out = Eigen::Isometry3f::Identity();
  out.linear() = scene.to_local.transpose() * turn * model.to_local;
  out.translation() = scene.origin - out.linear() * model.origin;
  return out;
}

}  // namespace

std::vector<Eigen::Isometry3f> VotedPoses(const PairModel& model, const OrientedCloud& scene,
                                          const PairVotesParameters& parameters,
                                          const IsCancelled& is_cancelled) {
  std::vector<Eigen::Isometry3f> out;
  Accumulator votes(model.points.points.size());
  std::vector<Peak> peaks;
  CancellationPoll poll(is_cancelled);
  const std::size_t count = scene.points.size();
  const std::size_t references = std::min(parameters.reference_count, count);
  const float reach = model.diameter_m * model.diameter_m;
  const SoaCloud columns(scene);
  const simd::Coordinates coordinates = columns.coordinates().points;
  std::vector<float> distances(coordinates.count);
  for (std::size_t r = 0; r < references; ++r) {
    const std::size_t i = r * count / references;
    const ReferenceFrame frame(scene.points[i], scene.normals[i]);
    votes.Clear();
    if (poll.After(20 * count)) return out;
    simd::Best().squared_distances(coordinates, frame.origin.data(), distances.data());
    for (std::size_t j = 0; j < count; ++j) {
      if (distances[j] > reach || i == j) continue;
      const auto pairs =
          model.table->Find(frame.origin, scene.normals[i], scene.points[j], scene.normals[j]);
      if (pairs.empty()) continue;
      const std::uint16_t turn = frame.TurnOf(scene.points[j]);
      for (const PairTable::Entry& pair : pairs) {
        votes.Add(pair.point, static_cast<std::uint16_t>(turn - pair.turn));
      }
    }
    votes.FindPeaks(parameters.peak_count, &peaks);
    for (const Peak& peak : peaks) {
      constexpr float kBinRad = 2 * std::numbers::pi_v<float> / kTurnBins;
      out.push_back(
          PoseOf(frame, model.frames[peak.point], static_cast<float>(peak.bin + 1) * kBinRad));
    }
  }
  return out;
}

}  // namespace graspdb::recognition
