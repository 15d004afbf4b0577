#include "lab/experiment/trials/trial.h"

#include <gtest/gtest.h>

#include <set>

#include "lab/experiment/trials/cases.h"
#include "rendering/sample_parts.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::lab {
namespace {

using testing::IsOk;

rendering::DepthCameraModel Ideal() {
  rendering::DepthCameraModel model = rendering::KinectV2();
  model.noise.scale = 0;
  return model;
}

class TrialTest : public ::testing::Test {
 protected:
  // Points of the scan above the table in the region of interest.
  std::size_t Above(const Obstacle& obstacle, const rendering::DepthCameraModel& camera = Ideal()) {
    const auto renderer = TrialRenderer::Create(parts_, camera);
    EXPECT_THAT(renderer, IsOk());
    rendering::PlannedCapture capture{.path = "",
                                      .split = v1::Capture::QUERY,
                                      .placements = {{.part = 0}},
                                      .world_sensor = rendering::LookAt({0, 0, 0}, 0.8, 40, -90),
                                      .seed = 1};
    const auto trial = renderer->Render(capture, obstacle);
    EXPECT_THAT(trial, IsOk());
    if (!trial.ok()) return 0;
    std::size_t above = 0;
    for (const auto& p : trial->scan.points) {
      const Eigen::Vector3d world = capture.world_sensor * p.cast<double>();
      above += p.allFinite() && world.z() > 0.002 && trial->scan.region->Contains(world);
    }
    return above;
  }

  const std::vector<rendering::Workpiece> parts_ = rendering::SampleParts();
};

TEST_F(TrialTest, ObstacleHidesItsShareFromAnySide) {
  const auto all = static_cast<double>(Above({}));
  ASSERT_GT(all, 500);
  for (const double direction : {0.0, 1.0, 2.5, 4.0, 5.5}) {
    const auto left = static_cast<double>(Above({.hidden_share = 0.4, .direction_rad = direction}));
    EXPECT_NEAR(left / all, 0.6, 0.05) << direction;
  }
}

TEST_F(TrialTest, ObstacleShadowDoesNotExceedTheHiddenShare) {
  rendering::DepthCameraModel camera = Ideal();
  camera.effects.shadow_baseline_m = 0.075;
  const auto all = static_cast<double>(Above({}, camera));
  for (const double direction : {0.0, 1.0, 2.5, 4.0, 5.5}) {
    const auto left =
        static_cast<double>(Above({.hidden_share = 0.4, .direction_rad = direction}, camera));
    EXPECT_NEAR(left / all, 0.6, 0.08) << direction;
  }
}

TEST(Cases, WithOtherQueriesOnlyTeachAlike) {
  const ExperimentCase seen{.name = "seen"};
  ExperimentCase other = seen;
  other.name = "other";
  other.hidden_share = 0.4;
  other.queried.camera = rendering::Carmine();
  other.parts = PartChoice::kStrangers;
  EXPECT_TRUE(TeachesAlike(seen, other));
  other.parts = PartChoice::kRound;
  EXPECT_FALSE(TeachesAlike(seen, other));
  other = seen;
  other.taught.camera = rendering::Carmine();
  EXPECT_FALSE(TeachesAlike(seen, other));
  other = seen;
  other.seed = 2;
  EXPECT_FALSE(TeachesAlike(seen, other));
}

TEST(Cases, OfThePaperQueryBetweenTheTaughtAzimuths) {
  PartSet set;
  set.Add(TwinParts(), 0);
  set.taught_count = 1;
  for (const ExperimentCase& experiment : ExperimentCases()) {
    if (!experiment.between_taught_azimuths) continue;
    const auto taught = PlanTeaching(experiment, set);
    const auto queries = PlanQueries(experiment, set);
    ASSERT_THAT(taught, IsOk());
    ASSERT_THAT(queries, IsOk());
    EXPECT_EQ(taught->size(), 24U);
    EXPECT_EQ(queries->size(), 96U);
    for (const rendering::PlannedCapture& query : *queries) {
      for (const rendering::PlannedCapture& view : *taught) {
        EXPECT_FALSE(query.placements[0].world_object.isApprox(view.placements[0].world_object));
      }
    }
    return;
  }
  FAIL() << "the paper's protocol is not among the cases";
}

TEST(Cases, HaveUniqueNames) {
  std::set<std::string> names;
  for (const ExperimentCase& experiment : ExperimentCases()) {
    EXPECT_TRUE(names.insert(experiment.name).second) << experiment.name;
  }
}

}  // namespace
}  // namespace graspdb::lab
