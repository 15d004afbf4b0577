#include "tests/lab/experiment/hand_made_case.h"

#include "rendering/sample_parts.h"

namespace graspdb::lab {

PartSet HandMadeParts() {
  PartSet set;
  const std::vector<rendering::Workpiece> samples = rendering::SampleParts();
  for (std::size_t i = 0; i < 4; ++i) {
    const recognition::Points points = rendering::SampleSurface(samples[i].mesh, 50, /*seed=*/1);
    set.parts.push_back(samples[i]);
    set.shapes.push_back(std::make_shared<rendering::MeasuredShape>(
        rendering::MeasuredShape{points,
                                 recognition::PointSearch(points),
                                 rendering::DiameterOf(samples[i].mesh),
                                 {0},
                                 false,
                                 false}));
    set.object_mesh.push_back(recognition::Pose::Identity());
  }
  set.taught_count = set.parts.size() - 1;
  return set;
}

Answer RightAnswer(const PartSet& set, std::size_t part, std::size_t scene) {
  return {.part = part,
          .scene = scene,
          .outcome = recognition::RecognitionOutcome::kOk,
          .stable_pose = StablePoseName(set.parts[part]),
          .object_right = true,
          .pose_right = true,
          .strictly_right = true,
          .error = {.add_s_m = 0.001,
                    .hausdorff_m = 0.002,
                    .rotation_rad = 0.01,
                    .translation_m = 0.0005},
          .score = 0.95,
          .milliseconds = 40};
}

CaseResult HandMade(const std::string& name) {
  CaseResult out{.experiment = {.name = name, .hidden_share = 0.2}, .set = HandMadeParts()};
  const std::size_t stranger = out.set.parts.size() - 1;
  out.answers.push_back(RightAnswer(out.set, 0, 0));
  out.answers.push_back(RightAnswer(out.set, 1, 1));
  out.answers.back().milliseconds = 80;
  Answer taken{.part = 0, .scene = 2, .outcome = recognition::RecognitionOutcome::kOk};
  taken.stable_pose = StablePoseName(out.set.parts[1]);
  taken.score = 0.62;
  taken.milliseconds = 60;
  out.answers.push_back(taken);
  out.answers.push_back({.part = 1, .scene = 3, .milliseconds = 20});
  out.answers.push_back({.part = stranger,
                         .scene = 4,
                         .known = false,
                         .outcome = recognition::RecognitionOutcome::kUnknownObject,
                         .object_right = true,
                         .milliseconds = 100});
  return out;
}

}  // namespace graspdb::lab
