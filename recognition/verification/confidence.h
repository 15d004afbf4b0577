// Confidence of a hypothesis; docs/adr/0022-confidence-by-what-was-confirmed.md.
#pragma once

#include "recognition/models/surface_model.h"
#include "recognition/segmentation/segmentation.h"
#include "recognition/verification/verification.h"

namespace graspdb::recognition {

// Deviation of single depth measurements at `segment`, m: that of the points of the table. Without
// a table, 1.5 mm up to 0.8 m, and proportional to the distance beyond.
double NoiseAt(const Segmentation& segmentation, const Segment& segment);

// Features that count against a hypothesis; 0 where nothing does.
struct ConfidenceFeatures {
  double scan = 0;          // unexplained share of the segment, beyond the noise
  double contradicted = 0;  // of the measured model surface: share with something else there
  double residual = 0;      // of the points that match, above the expected one, as a share of it
  double unseen = 0;        // natural logarithm of sufficient / confirmed share of the model
  double little = 0;        // the same for the segment's points
};

// `noise_m`: see NoiseAt. `tolerance_m`: that `evidence` was made with.
ConfidenceFeatures ConfidenceFeaturesOf(const Evidence& evidence, const SurfaceModel& model,
                                        double noise_m, double tolerance_m);

// Share of answers with such features that are right, 0 to 1: a logistic regression over frames of
// real cameras and scenes of simulated ones, half of which show an object that was never taught
// (tests/eval/fit_confidence.py, docs/experiment.md).
double Confidence(const ConfidenceFeatures& features);

// The highest possible confidence for a segment with `point_count` voxels. `noise_m`: see NoiseAt.
double MaxConfidence(std::size_t point_count, double noise_m);

// The feature with the largest weight; kLittleSeen: `unseen` and `little` together; kExtent: the
// segment is too large to be one object; kMinScore: by default the confidence would be enough.
enum class Gate { kScan, kModel, kResidual, kExtent, kLittleSeen, kMinScore };
Gate HeaviestFeature(const ConfidenceFeatures& features);

}  // namespace graspdb::recognition
