#include "recognition/verification/confidence.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace graspdb::recognition {
namespace {

// Noise of a camera that shows no table, m, and as far as this from it. Farther away it grows:
// time of flight by less than the distance, triangulation by its square.
constexpr double kUnknownNoiseM = 0.0015;
constexpr double kUnknownNoiseAtM = 0.8;
// A segment's points are voxels: ratio of their deviation to that of single pixels.
constexpr double kVoxelNoise = 0.8;
// Sufficient share of the facing surface: answers are expected with 40 % hidden. Doubled, partly
// hidden objects lose confidence.
constexpr double kEnoughSeen = 0.6;
// Sufficient number of voxels at this noise, m: 27 cm2 at 3 mm. The information on a shape grows
// with the number of points and falls with the variance of their noise (Fisher information).
// Doubled, small objects lose confidence; halved, pieces of clutter are taken for them.
constexpr double kEnoughPoints = 300;
constexpr double kAtNoiseM = 0.002;

// The regression's coefficients.
constexpr double kOffset = 3.5;
constexpr double kScan = 7.1;
constexpr double kContradicted = 18;
constexpr double kResidual = 4.8;
constexpr double kUnseen = 7;
constexpr double kLittle = 3.9;

// Natural logarithm of `enough` / `there`; 0 where there is enough.
double Lack(double there, double enough) {
  constexpr double kMin = 0.01;  // of `enough`
  return std::max(0.0, -std::log(std::max(there / enough, kMin)));
}

// Voxels that are enough where the deviation of a depth measurement is `noise_m`.
double EnoughPoints(double noise_m) {
  const double ratio = noise_m / kAtNoiseM;
  return kEnoughPoints * ratio * ratio;
}

// In the order of Gate.
std::array<std::pair<Gate, double>, 4> WeightsOf(const ConfidenceFeatures& features) {
  return {{{Gate::kScan, kScan * features.scan},
           {Gate::kModel, kContradicted * features.contradicted},
           {Gate::kResidual, kResidual * features.residual},
           {Gate::kLittleSeen, kUnseen * features.unseen + kLittle * features.little}}};
}

}  // namespace

double NoiseAt(const Segmentation& segmentation, const Segment& segment) {
  if (segmentation.table_noise_m > 0) return segmentation.table_noise_m;
  const double distance = (segment.centroid - segmentation.world_sensor.translation()).norm();
  return kUnknownNoiseM * std::max(1.0, distance / kUnknownNoiseAtM);
}

ConfidenceFeatures ConfidenceFeaturesOf(const Evidence& evidence, const SurfaceModel& model,
                                        double noise_m, double tolerance_m) {
  const double noise = std::max(noise_m, static_cast<double>(model.deviation_m));
  // Both the scan and a model of few views are noisy.
  const double expected = noise * std::sqrt(1 + 1.0 / std::max(1, model.view_count));
  const double blur = kVoxelNoise * noise / tolerance_m;
  const double measured = evidence.confirmed + evidence.contradicted;
  return {.scan = std::max(0.0, 1 - evidence.scan_explained - blur * blur),
          .contradicted = measured > 0 ? evidence.contradicted / measured : 0,
          .residual = std::max(0.0, evidence.rms_m / expected - 1),
          .unseen = Lack(evidence.confirmed, kEnoughSeen),
          .little = Lack(static_cast<double>(evidence.point_count), EnoughPoints(expected))};
}

double Confidence(const ConfidenceFeatures& features) {
  double against = -kOffset;
  for (const auto& [gate, weight] : WeightsOf(features)) against += weight;
  return 1 / (1 + std::exp(against));
}

double MaxConfidence(std::size_t point_count, double noise_m) {
  // No model makes the expected residual smaller than the noise.
  return Confidence({.little = Lack(static_cast<double>(point_count), EnoughPoints(noise_m))});
}

Gate HeaviestFeature(const ConfidenceFeatures& features) {
  const auto weights = WeightsOf(features);
  return std::ranges::max_element(weights, {}, &std::pair<Gate, double>::second)->first;
}

}  // namespace graspdb::recognition
