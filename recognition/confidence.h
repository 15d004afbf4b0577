// How sure an explanation is.
#pragma once

#include "recognition/surface_model.h"
#include "recognition/verification.h"

namespace graspdb::recognition {

// What speaks for and against an explanation, in units of what a right one shows.
struct Doubt {
  double scan = 0;      // share of the segment that the noise does not explain away
  double model = 0;     // share of the model in sight that was not measured
  double residual = 0;  // of the points that match, in units of the expected one; a right
                        // explanation has about 1
};

// `table_noise_m`: see Segmentation; 0 where it is not known. `tolerance_m`: that `evidence` was
// made with.
Doubt DoubtsOf(const Evidence& evidence, const SurfaceModel& model, double table_noise_m,
               double tolerance_m);

// Share of answers with such doubts that are right, 0 to 1: a logistic regression over simulated
// scenes, half of which show something that was never taught (docs/experiment.md).
double Confidence(const Doubt& doubt);

// Which doubt weighs most; kExtent: the segment is too large to be one object.
enum class Gate { kScan, kModel, kResidual, kExtent };
Gate HeaviestDoubt(const Doubt& doubt);

}  // namespace graspdb::recognition
