// How sure an explanation is; docs/adr/0022-confidence-by-what-was-confirmed.md.
#pragma once

#include "recognition/models/surface_model.h"
#include "recognition/segmentation/segmentation.h"
#include "recognition/verification/verification.h"

namespace graspdb::recognition {

// Deviation of single depth measurements at `segment`, m: that of the points of the table. Where
// none was seen, 1.5 mm as far as 0.8 m, and proportional to the distance beyond.
double NoiseAt(const Segmentation& segmentation, const Segment& segment);

// What speaks against an explanation; 0 where nothing does.
struct ConfidenceFeatures {
  double scan = 0;          // share of the segment that the noise does not explain away
  double contradicted = 0;  // of the model's surface that was measured: share with something else
  double residual = 0;      // of the points that match, above the expected one, as a share of it
  double unseen = 0;  // natural logarithm of how many times too little of the model was confirmed
  double little = 0;  // the same of the segment's points
};

// `noise_m`: see NoiseAt. `tolerance_m`: that `evidence` was made with.
ConfidenceFeatures ConfidenceFeaturesOf(const Evidence& evidence, const SurfaceModel& model,
                                        double noise_m, double tolerance_m);

// Share of answers with such doubts that are right, 0 to 1: a logistic regression over frames of
// real cameras and over scenes that simulated ones see, half of which show something that was never
// taught (tests/eval/fit_confidence.py, docs/experiment.md).
double Confidence(const ConfidenceFeatures& features);

// The highest confidence that any explanation of a segment with `point_count` voxels can have.
// `noise_m`: see NoiseAt.
double MaxConfidence(std::size_t point_count, double noise_m);

// Which doubt weighs most; kLittleSeen: `unseen` and `little` together; kExtent: the segment is too
// large to be one object.
enum class Gate { kScan, kModel, kResidual, kExtent, kLittleSeen };
Gate HeaviestFeature(const ConfidenceFeatures& features);

}  // namespace graspdb::recognition
