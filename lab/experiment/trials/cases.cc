#include "lab/experiment/trials/cases.h"

#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "lab/experiment/trials/close_scene.h"
#include "rendering/random/counter_random.h"

namespace graspdb::lab {
namespace {

enum ObstacleStream : std::uint64_t { kObstacleSide = 100 };

// The obstacle of a query; none unless the case hides something.
Obstacle ObstacleOf(const ExperimentCase& experiment, std::size_t query) {
  return {.hidden_share = experiment.hidden_share,
          .direction_rad = 2 * std::numbers::pi *
                           rendering::RandomUniform(experiment.seed, kObstacleSide, query),
          .cut_out = experiment.cut_out};
}

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

// Footprints are points, of which neighbours are some millimetres apart: objects with this gap
// between them touch, or nearly.
constexpr double kTouchingGapM = 0.002;

// The step of BigBIRD's turntable.
constexpr double kQueryStepDeg = 3;

rendering::CameraStand StandOf(const Stand& stand) {
  return {.look_down_deg = stand.look_down_deg, .distances_m = {stand.distance_m}};
}

// All objects, taught without the errors of a real camera and recognized with them.
void AddRealCameras(std::vector<ExperimentCase>* cases) {
  struct Camera {
    const char* name;
    rendering::DepthCameraModel model;
    double distance_m;
  };
  for (const Camera& camera : {Camera{"kinect-v1", rendering::RealKinectV1(), 1.0},
                               {"kinect-v2", rendering::RealKinectV2(), 0.8},
                               {"realsense-d4xx", rendering::RealSenseD4xx(), 0.8},
                               {"carmine", rendering::Carmine(), 0.8}}) {
    ExperimentCase seen{.name = std::string("real-") + camera.name,
                        .teach_step_deg = 20,
                        .queried = {.camera = camera.model, .distance_m = camera.distance_m},
                        .parts = PartChoice::kEverything,
                        .only_named = true};
    cases->push_back(seen);
    for (const int percent : {20, 40}) {
      cases->push_back(seen);
      cases->back().name += absl::StrCat("-hidden-", percent);
      cases->back().hidden_share = percent / 100.0;
    }
    ExperimentCase cut_out = cases->back();
    cut_out.name = seen.name + "-segmented-40";
    cut_out.cut_out = true;
    cases->push_back(cut_out);
    seen.parts = cut_out.parts = PartChoice::kStrangers;
    seen.name += "-unknown";
    cases->push_back(seen);
    cut_out.name = seen.name + "-segmented-40";
    cases->push_back(cut_out);
    seen.name += "-hidden-40";
    seen.hidden_share = 0.4;
    cases->push_back(seen);
  }
}

// Every part at the centre, at azimuths between the taught ones.
absl::StatusOr<std::vector<rendering::PlannedCapture>> PlanBetween(const ExperimentCase& experiment,
                                                                   const PartSet& set) {
  ASSIGN_OR_RETURN(auto plan,
                   rendering::PlanTurntable(set.parts, {.stand = StandOf(experiment.queried),
                                                        .azimuth_step_deg = kQueryStepDeg,
                                                        .seed = experiment.seed + 1}));
  const auto steps = static_cast<std::size_t>(std::lround(360 / kQueryStepDeg));
  const auto taught_every =
      static_cast<std::size_t>(std::lround(experiment.teach_step_deg / kQueryStepDeg));
  std::vector<rendering::PlannedCapture> between;
  for (std::size_t i = 0; i < plan.size(); ++i) {
    if ((i % steps) % taught_every != 0) between.push_back(std::move(plan[i]));
  }
  return between;
}

}  // namespace

std::vector<ExperimentCase> ExperimentCases() {
  std::vector<ExperimentCase> cases;
  const auto add = [&](const std::string& name) -> ExperimentCase& {
    cases.push_back({.name = name});
    return cases.back();
  };
  add("paper").between_taught_azimuths = true;
  ExperimentCase& bigbird = add("paper-five-cameras");
  bigbird.between_taught_azimuths = true;
  bigbird.taught.look_down_deg = {15, 30, 45, 60, 75};
  bigbird.queried = bigbird.taught;
  add("anywhere");
  add("noise").queried.camera.noise.scale = 2;
  add("camera-higher").queried.look_down_deg = {45};
  add("camera-lower").queried.look_down_deg = {35};
  ExperimentCase& above = add("camera-above");
  above.taught.look_down_deg = {85};
  above.queried = above.taught;
  ExperimentCase& v1 = add("kinect-v1");
  v1.taught = {.camera = rendering::KinectV1(), .distance_m = 1.3};
  v1.queried = v1.taught;
  v1.teach_step_deg = 30;
  add("hidden-20").hidden_share = 0.2;
  add("hidden-40").hidden_share = 0.4;
  ExperimentCase& everything = add("everything");
  everything.parts = PartChoice::kEverything;
  everything.teach_step_deg = 20;
  ExperimentCase& cad = add("cad");
  cad.parts = PartChoice::kDropPoses;
  cad.teach_step_deg = 20;
  for (const auto& [name, gap_m] :
       {std::pair("three-objects", 0.03), {"three-objects-2cm", 0.02}}) {
    ExperimentCase& three = add(name);
    three.objects_per_scene = 3;
    three.area_half_width_m = 0.10;
    three.gap_m = gap_m;
  }
  ExperimentCase& touching = add("touching");
  touching.objects_per_scene = 2;
  touching.area_half_width_m = 0.10;
  touching.gap_m = kTouchingGapM;
  add("symmetric").parts = PartChoice::kRound;
  add("unknown").parts = PartChoice::kStrangers;
  ExperimentCase& hidden_stranger = add("unknown-hidden-20");
  hidden_stranger.parts = PartChoice::kStrangers;
  hidden_stranger.hidden_share = 0.2;
  add("twins").parts = PartChoice::kTwins;
  ExperimentCase& cut_out = add("segmented-40");
  cut_out.hidden_share = 0.4;
  cut_out.cut_out = true;
  AddRealCameras(&cases);
  return cases;
}

bool TeachesAlike(const ExperimentCase& a, const ExperimentCase& b) {
  const auto orientations_of = [](PartChoice parts) {
    return parts == PartChoice::kStrangers ? PartChoice::kMain : parts;
  };
  return a.taught == b.taught && a.teach_step_deg == b.teach_step_deg && a.seed == b.seed &&
         orientations_of(a.parts) == orientations_of(b.parts);
}

absl::StatusOr<std::vector<rendering::PlannedCapture>> PlanTeaching(
    const ExperimentCase& experiment, const PartSet& set) {
  const std::vector<rendering::Workpiece> taught(
      set.parts.begin(), set.parts.begin() + static_cast<std::ptrdiff_t>(set.taught_count));
  return rendering::PlanTurntable(taught, {.stand = StandOf(experiment.taught),
                                           .azimuth_step_deg = experiment.teach_step_deg,
                                           .seed = experiment.seed});
}

absl::StatusOr<std::vector<rendering::PlannedCapture>> PlanQueries(const ExperimentCase& experiment,
                                                                   const PartSet& set) {
  if (experiment.between_taught_azimuths) return PlanBetween(experiment, set);
  const int count = experiment.trials_per_part * static_cast<int>(set.parts.size());
  const std::uint64_t seed = experiment.seed + 1;
  if (experiment.objects_per_scene > 1) {
    return PlanCloseScenes(set.parts, {.stand = StandOf(experiment.queried),
                                       .count = (count + experiment.objects_per_scene - 1) /
                                                experiment.objects_per_scene,
                                       .objects_per_scene = experiment.objects_per_scene,
                                       .gap_m = experiment.gap_m,
                                       .area_half_width_m = experiment.area_half_width_m,
                                       .seed = seed});
  }
  auto plan = rendering::PlanRandomScenes(
      set.parts,
      {.stand = StandOf(experiment.queried),
       .count = set.queried_parts.empty() ? count : static_cast<int>(set.queried_parts.size()),
       .area_half_width_m = experiment.area_half_width_m,
       .seed = seed});
  if (!plan.ok()) return plan;
  for (std::size_t i = 0; i < set.queried_parts.size(); ++i) {
    (*plan)[i].placements.front().part = set.queried_parts[i];
  }
  return plan;
}

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
