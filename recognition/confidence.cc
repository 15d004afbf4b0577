#include "recognition/confidence.h"

#include <algorithm>
#include <cmath>

namespace graspdb::recognition {
namespace {

// Noise of a camera that shows no table, m.
constexpr double kUnknownNoiseM = 0.0015;
// A segment's points are voxels: their deviation is so many times that of single pixels.
constexpr double kVoxelNoise = 0.8;

// The regression's coefficients; ADR 18 says why the offset is not its own.
constexpr double kOffset = 4.5;
constexpr double kScan = 5;
constexpr double kModel = 57;
constexpr double kResidual = 8.9;

// A residual that is smaller than the expected one by more than this share says no more.
constexpr double kBestResidual = 0.7;

struct Weights {
  double scan = 0;
  double model = 0;
  double residual = 0;
};

Weights WeightsOf(const Doubt& doubt) {
  return {.scan = kScan * doubt.scan,
          .model = kModel * doubt.model,
          .residual = kResidual * (std::max(doubt.residual, kBestResidual) - 1)};
}

}  // namespace

Doubt DoubtsOf(const Evidence& evidence, const SurfaceModel& model, double table_noise_m,
               double tolerance_m) {
  const double noise = std::max(table_noise_m > 0 ? table_noise_m : kUnknownNoiseM,
                                static_cast<double>(model.deviation_m));
  // Both the scan and a model of few views are noisy.
  const double expected = noise * std::sqrt(1 + 1.0 / std::max(1, model.view_count));
  const double blur = kVoxelNoise * noise / tolerance_m;
  return {.scan = std::max(0.0, 1 - evidence.scan_explained - blur * blur),
          .model = 1 - evidence.model_seen,
          .residual = evidence.rms_m / expected};
}

double Confidence(const Doubt& doubt) {
  const Weights weights = WeightsOf(doubt);
  return 1 / (1 + std::exp(weights.scan + weights.model + weights.residual - kOffset));
}

Gate HeaviestDoubt(const Doubt& doubt) {
  const Weights weights = WeightsOf(doubt);
  if (weights.residual >= weights.scan && weights.residual >= weights.model) return Gate::kResidual;
  return weights.scan >= weights.model ? Gate::kScan : Gate::kModel;
}

}  // namespace graspdb::recognition
