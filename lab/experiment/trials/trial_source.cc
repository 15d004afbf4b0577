#include "lab/experiment/trials/trial_source.h"

#include <memory>
#include <utility>
#include <vector>

#include "base/status_macros.h"

namespace graspdb::lab {
namespace {

// With the obstacles of `query_case` if it is not null.
absl::StatusOr<TrialSource> Rendered(std::vector<rendering::PlannedCapture> plan,
                                     const PartSet& set, const rendering::DepthCameraModel& camera,
                                     const ExperimentCase* query_case) {
  ASSIGN_OR_RETURN(auto made, TrialRenderer::Create(set.parts, camera));
  struct Shared {
    TrialRenderer renderer;
    std::vector<rendering::PlannedCapture> plan;
  };
  auto shared = std::make_shared<const Shared>(Shared{std::move(made), std::move(plan)});
  const std::size_t count = shared->plan.size();
  if (query_case == nullptr) {
    return TrialSource{
        count, [shared](std::size_t i) { return shared->renderer.Render(shared->plan[i]); }};
  }
  return TrialSource{count, [shared, experiment = *query_case](std::size_t i) {
                       return shared->renderer.Render(shared->plan[i], ObstacleOf(experiment, i));
                     }};
}

}  // namespace

absl::StatusOr<ExperimentTrials> RenderedTrials(const ExperimentCase& experiment,
                                                const PartSet& set) {
  ASSIGN_OR_RETURN(auto teaching, PlanTeaching(experiment, set));
  ASSIGN_OR_RETURN(auto planned, PlanQueries(experiment, set));
  ASSIGN_OR_RETURN(auto taught,
                   Rendered(std::move(teaching), set, experiment.taught.camera, nullptr));
  ASSIGN_OR_RETURN(auto queries,
                   Rendered(std::move(planned), set, experiment.queried.camera, &experiment));
  return ExperimentTrials{std::move(taught), std::move(queries), false};
}

}  // namespace graspdb::lab
