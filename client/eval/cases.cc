#include "client/eval/cases.h"

#include <cmath>
#include <numbers>

#include "client/sensors/counter_random.h"

namespace graspdb::client {
namespace {

enum Stream : std::uint64_t { kObstacleSide = 100 };

// The step of BigBIRD's turntable.
constexpr double kAskStepDeg = 3;

}  // namespace

std::vector<ExperimentCase> ExperimentCases() {
  std::vector<ExperimentCase> cases;
  const auto add = [&](const std::string& name) -> ExperimentCase& {
    cases.push_back({.name = name});
    return cases.back();
  };
  add("paper").between_taught_azimuths = true;
  add("anywhere");
  add("noise").asked.camera.noise.scale = 2;
  add("camera-higher").asked.look_down_deg = 45;
  add("camera-lower").asked.look_down_deg = 35;
  ExperimentCase& v1 = add("kinect-v1");
  v1.taught = {.camera = KinectV1(), .distance_m = 1.3};
  v1.asked = v1.taught;
  v1.teach_step_deg = 30;
  add("hidden-20").hidden_share = 0.2;
  add("hidden-40").hidden_share = 0.4;
  return cases;
}

absl::StatusOr<std::vector<PlannedCapture>> PlanTeaching(const ExperimentCase& experiment,
                                                         const std::vector<Workpiece>& parts) {
  return PlanTurntable(parts, {.stand = {.look_down_deg = {experiment.taught.look_down_deg},
                                         .distances_m = {experiment.taught.distance_m}},
                               .azimuth_step_deg = experiment.teach_step_deg,
                               .seed = experiment.seed});
}

absl::StatusOr<std::vector<PlannedCapture>> PlanQuestions(const ExperimentCase& experiment,
                                                          const std::vector<Workpiece>& parts) {
  const CameraStand stand{.look_down_deg = {experiment.asked.look_down_deg},
                          .distances_m = {experiment.asked.distance_m}};
  if (!experiment.between_taught_azimuths) {
    return PlanRandomScenes(parts,
                            {.stand = stand,
                             .count = experiment.trials_per_part * static_cast<int>(parts.size()),
                             .area_half_width_m = experiment.area_half_width_m,
                             .objects_per_scene = experiment.objects_per_scene,
                             .seed = experiment.seed + 1});
  }
  auto plan = PlanTurntable(
      parts, {.stand = stand, .azimuth_step_deg = kAskStepDeg, .seed = experiment.seed + 1});
  if (!plan.ok()) return plan.status();
  const auto steps = static_cast<std::size_t>(std::lround(360 / kAskStepDeg));
  const auto taught_every =
      static_cast<std::size_t>(std::lround(experiment.teach_step_deg / kAskStepDeg));
  std::vector<PlannedCapture> between;
  for (std::size_t i = 0; i < plan->size(); ++i) {
    if ((i % steps) % taught_every != 0) between.push_back(std::move((*plan)[i]));
  }
  return between;
}

Obstacle ObstacleOf(const ExperimentCase& experiment, std::size_t question) {
  return {.hidden_share = experiment.hidden_share,
          .direction_rad =
              2 * std::numbers::pi * RandomUniform(experiment.seed, kObstacleSide, question)};
}

}  // namespace graspdb::client
