// Sources of an experiment's trials.
#pragma once

#include <cstddef>
#include <functional>

#include "absl/status/statusor.h"
#include "lab/experiment/trials/cases.h"
#include "lab/experiment/trials/part_set.h"
#include "lab/experiment/trials/trial.h"

namespace graspdb::lab {

// Trials that are made on demand, since together they do not fit into memory.
struct TrialSource {
  std::size_t count = 0;
  // Of 0 … count - 1; thread-safe, and always the same.
  std::function<absl::StatusOr<Trial>(std::size_t)> make;
};

// Trials to teach and queries of an experiment.
struct ExperimentTrials {
  TrialSource teaching;
  TrialSource queries;
  // Trial i of `queries` is trial i of `teaching`, and is recognized without that view.
  bool leave_one_out = false;
};

// Rendered trials of a case; `set` outlives them. Errors as PlanTeaching, PlanQueries and
// TrialRenderer::Create.
absl::StatusOr<ExperimentTrials> RenderedTrials(const ExperimentCase& experiment,
                                                const PartSet& set);

}  // namespace graspdb::lab
