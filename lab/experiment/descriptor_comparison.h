// The paper's experiment on descriptors alone: no alignment, no verification.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "lab/experiment/descriptor_figures.h"
#include "lab/experiment/experiment_run.h"
#include "lab/experiment/trial_source.h"

namespace graspdb::lab {

// Every descriptor with every distance over `trials`, which show one object at a time. Objects that
// are not taught are left out. Descriptors in the order VFH-263, VFH-308, MVFH-300, GSH-288;
// distances chi-square, Hellinger, L1, L2. Errors as RunCase.
absl::StatusOr<std::vector<DescriptorFigures>> CompareDescriptors(const PartSet& set,
                                                                  const ExperimentTrials& trials,
                                                                  const ExperimentRun& run);

}  // namespace graspdb::lab
