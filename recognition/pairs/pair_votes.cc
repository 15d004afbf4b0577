#include "recognition/pairs/pair_votes.h"

#include <algorithm>
#include <array>
#include <numbers>

#include "recognition/base/idle_cores.h"
#include "recognition/simd/kernels.h"
#include "recognition/simd/soa_cloud.h"

namespace graspdb::recognition {
namespace {

// Bins of a whole turn, of 12 degrees, and what they take in memory: whole vectors.
constexpr std::size_t kTurnBins = 30;
constexpr std::size_t kStride = 32;

struct Peak {
  std::uint16_t votes = 0;
  std::size_t point = 0;  // of the model
  std::size_t bin = 0;    // and the next one
};

// Votes of one scene point: for each model point that it may be, and each turn about its normal.
class Accumulator {
 public:
  explicit Accumulator(std::size_t points) : votes_(points * kStride + 1, 0) {}

  void Clear() { std::ranges::fill(votes_, 0); }
  void Add(std::size_t point, std::uint16_t turn) {
    votes_[point * kStride + ((turn * kTurnBins) >> 16U)] += 1;
  }

  // The most votes in two bins side by side, of different model points, of those that `is_possible`
  // allows.
  template <typename IsPossible>
  void FindPeaks(std::size_t count, const IsPossible& is_possible, std::vector<Peak>* out) {
    out->clear();
    for (std::size_t point = 0; point * kStride + 1 < votes_.size(); ++point) {
      const std::array<std::uint16_t, kStride> sums = SumsOf(point);
      std::uint16_t votes = 0;
      for (const std::uint16_t sum : sums) votes = std::max(votes, sum);
      if (votes < kMinVotes) continue;
      if (out->size() == count && votes <= out->back().votes) continue;
      const auto bin = static_cast<std::size_t>(std::ranges::find(sums, votes) - sums.begin());
      if (!is_possible(point, bin)) continue;
      if (out->size() == count) out->pop_back();
      out->insert(std::ranges::upper_bound(*out, votes, std::greater(), &Peak::votes),
                  {votes, point, bin});
    }
  }

 private:
  // Fewer agree by chance.
  static constexpr std::uint16_t kMinVotes = 4;

  // Of each bin and the next one; 0 behind the last. The bins behind the last stay empty but for
  // the first one's copy.
  std::array<std::uint16_t, kStride> SumsOf(std::size_t point) {
    std::uint16_t* bins = votes_.data() + point * kStride;
    bins[kTurnBins] = bins[0];
    std::array<std::uint16_t, kStride> sums;
    for (std::size_t b = 0; b < kStride; ++b) {
      sums[b] = static_cast<std::uint16_t>(bins[b] + bins[b + 1]);
    }
    bins[kTurnBins] = 0;
    sums[kTurnBins] = sums[kTurnBins + 1] = 0;
    return sums;
  }

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

// References whose pairs are made at once: a model's table stays in the cache for their votes.
constexpr std::size_t kReferencesAtOnce = 5;

struct ScenePair {
  PairFeature feature;
  std::uint16_t turn = 0;
};

// A scene point that votes, with its partners.
struct Reference {
  ReferenceFrame frame;
  std::vector<ScenePair> pairs;
};

Reference ReferenceAt(std::size_t i, const OrientedCloud& scene, const SoaCloud& columns,
                      float reach_m) {
  Reference out{{scene.points[i], scene.normals[i]}, {}};
  const simd::Coordinates coordinates = columns.coordinates().points;
  std::vector<float> distances(coordinates.count);
  simd::Best().squared_distances(coordinates, out.frame.origin.data(), distances.data());
  for (std::size_t j = 0; j < scene.points.size(); ++j) {
    if (distances[j] > reach_m * reach_m || i == j) continue;
    const auto feature =
        FeatureOf(out.frame.origin, scene.normals[i], scene.points[j], scene.normals[j]);
    if (feature) out.pairs.push_back({*feature, out.frame.TurnOf(scene.points[j])});
  }
  return out;
}

void Vote(const Voting& voting, const Reference& reference, std::size_t peak_count,
          Accumulator* votes, VotedPoses* out) {
  const PairModel& model = *voting.model;
  votes->Clear();
  for (const ScenePair& pair : reference.pairs) {
    for (const PairTable::Entry& entry : model.table->Find(pair.feature)) {
      votes->Add(entry.point, static_cast<std::uint16_t>(pair.turn - entry.turn));
    }
  }
  const auto pose_of = [&](std::size_t point, std::size_t bin) {
    constexpr float kBinRad = 2 * std::numbers::pi_v<float> / kTurnBins;
    return PoseOf(reference.frame, model.frames[point], static_cast<float>(bin + 1) * kBinRad);
  };
  const auto is_possible = [&](std::size_t point, std::size_t bin) {
    return !voting.upright || pose_of(point, bin).linear().col(2).dot(voting.upright->up) >=
                                  voting.upright->min_cosine;
  };
  std::vector<Peak> peaks;
  votes->FindPeaks(peak_count, is_possible, &peaks);
  for (const Peak& peak : peaks) out->push_back(pose_of(peak.point, peak.bin));
}

}  // namespace

std::vector<VotedPoses> VoteForPoses(std::span<const Voting> models, const OrientedCloud& scene,
                                     const PairVotesParameters& parameters,
                                     const IsCancelled& is_cancelled) {
  float reach = 0;
  for (const Voting& voting : models) reach = std::max(reach, voting.model->diameter_m);
  const SoaCloud columns(scene);
  const std::size_t count = scene.points.size();
  const std::size_t references = std::min(parameters.reference_count, count);
  const std::size_t blocks = (references + kReferencesAtOnce - 1) / kReferencesAtOnce;
  std::vector<std::vector<VotedPoses>> of_block(blocks, std::vector<VotedPoses>(models.size()));
  ForEachIndex(blocks, [&](std::size_t block) {
    std::vector<Reference> voters;
    const std::size_t end = std::min(references, (block + 1) * kReferencesAtOnce);
    for (std::size_t r = block * kReferencesAtOnce; r < end; ++r) {
      if (is_cancelled()) return;
      voters.push_back(ReferenceAt(r * count / references, scene, columns, reach));
    }
    for (std::size_t m = 0; m < models.size() && !is_cancelled(); ++m) {
      Accumulator votes(models[m].model->points.points.size());
      for (const Reference& voter : voters) {
        Vote(models[m], voter, parameters.peak_count, &votes, &of_block[block][m]);
      }
    }
  });
  std::vector<VotedPoses> out(models.size());
  for (const auto& block : of_block) {
    for (std::size_t m = 0; m < models.size(); ++m) {
      out[m].insert(out[m].end(), block[m].begin(), block[m].end());
    }
  }
  return out;
}

}  // namespace graspdb::recognition
