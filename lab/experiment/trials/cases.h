// The cases of the experiment: captures to teach and queries.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "lab/experiment/trials/part_set.h"
#include "lab/experiment/trials/trial.h"

namespace graspdb::lab {

// Camera and its pose.
struct Stand {
  rendering::DepthCameraModel camera = rendering::KinectV2();
  std::vector<double> look_down_deg = {40};  // more than one: as many cameras, in turn
  double distance_m = 0.8;
  bool operator==(const Stand&) const = default;
};

struct ExperimentCase {
  std::string name;
  Stand taught = {};
  double teach_step_deg = 15;
  Stand queried = {};
  // Azimuths between the taught ones, the object at the centre; otherwise anywhere in the area.
  bool between_taught_azimuths = false;
  double area_half_width_m = 0.15;
  double hidden_share = 0;
  bool cut_out = false;       // see Obstacle
  int objects_per_scene = 1;  // more than one: close together, each one queried
  double gap_m = 0.03;        // between neighbours
  PartChoice parts = PartChoice::kMain;
  int trials_per_part = 24;
  std::uint64_t seed = 1;
  bool only_named = false;  // run only on request, as one of many similar cases
  // Text for teaching and queries that differ from the members above.
  std::string settings = {};
  bool is_simulated = true;  // false: captures of a set, which the members above do not describe
};

// The cases by name, in the order of the report.
std::vector<ExperimentCase> ExperimentCases();

// Whether two cases teach parts of the same names by the same captures.
bool TeachesAlike(const ExperimentCase& a, const ExperimentCase& b);

// The captures to teach and the queries. Errors as PlanTurntable and PlanCloseScenes.
absl::StatusOr<std::vector<rendering::PlannedCapture>> PlanTeaching(
    const ExperimentCase& experiment, const PartSet& set);
absl::StatusOr<std::vector<rendering::PlannedCapture>> PlanQueries(const ExperimentCase& experiment,
                                                                   const PartSet& set);

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
