#include "tests/bench/catalogue.h"

#include <cstdio>
#include <cstdlib>

#include "absl/strings/str_format.h"
#include "rendering/sample_parts.h"
#include "tests/bench/seen_parts.h"

namespace graspdb::bench {
namespace {

using recognition::IndexedView;
using recognition::OrientedCloud;
using recognition::TaughtStablePose;
using recognition::TaughtView;

}  // namespace

Catalogue::Catalogue(std::size_t view_count) {
  const std::vector<rendering::Workpiece> parts = rendering::SampleParts();
  const std::vector<SeenPart> seen = SeeParts(parts);
  if (seen.empty()) {
    std::fprintf(stderr, "graspdb_bench: the simulated camera shows no part\n");
    std::exit(1);
  }
  auto poses =
      std::make_shared<std::unordered_map<std::string, std::shared_ptr<const TaughtStablePose>>>();
  std::vector<IndexedView> indexed;
  Stretches stretches(parts.size());
  for (std::size_t variant = 0; indexed.size() < view_count; ++variant) {
    const std::vector<Eigen::Vector3f> factors = stretches.Next();
    std::vector<std::shared_ptr<TaughtStablePose>> made(parts.size());
    for (std::size_t p = 0; p < parts.size(); ++p) {
      made[p] = std::make_shared<TaughtStablePose>();
      made[p]->name = absl::StrFormat("objects/%s-%d/stablePoses/%s", parts[p].object_id, variant,
                                      parts[p].stable_pose_id);
      made[p]->symmetry_order = parts[p].symmetry_order;
      made[p]->grasps.push_back({.id = "top"});
    }
    for (const SeenPart& s : seen) {
      if (indexed.size() == view_count) break;
      const auto cloud = std::make_shared<const OrientedCloud>(StretchedCloud(s, factors[s.part]));
      auto descriptor =
          recognition::Describe(*cloud, s.world_sensor, recognition::DescriptorKind::kGsh288);
      if (!descriptor.ok()) continue;
      auto view = std::make_shared<TaughtView>();
      view->stable_pose = made[s.part]->name;
      view->object = absl::StrFormat("objects/%s-%d", parts[s.part].object_id, variant);
      view->name = absl::StrFormat("%s/views/%06d", view->stable_pose, indexed.size());
      view->content = view->name;
      view->world_object = s.world_object;
      view->world_sensor = s.world_sensor;
      view->shares_frame = true;
      made[s.part]->views.push_back(view);
      Add(view->name, cloud);
      views_.push_back({view, cloud, *descriptor});
      indexed.push_back({view, *std::move(descriptor)});
    }
    for (auto& pose : made) (*poses)[pose->name] = std::move(pose);
  }
  snapshot_.index = snapshot_.index.With(indexed);
  snapshot_.stable_poses = std::move(poses);
}

}  // namespace graspdb::bench
