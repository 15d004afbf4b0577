#include "tests/bench/catalogue.h"

#include <cstdio>
#include <cstdlib>
#include <random>

#include "absl/strings/str_format.h"
#include "client/eval/trial.h"
#include "client/sensors/sample_parts.h"

namespace graspdb::bench {
namespace {

using recognition::IndexedView;
using recognition::OrientedCloud;
using recognition::Pose;
using recognition::TaughtStablePose;
using recognition::TaughtView;

constexpr std::uint64_t kSeed = 7;

// What was seen of one part from one side.
struct Seen {
  std::size_t part;
  Pose world_object;
  Pose world_sensor;
  OrientedCloud cloud;
};

std::vector<Seen> SeeParts(const std::vector<client::Workpiece>& parts) {
  const auto plan = client::PlanTurntable(parts, {});
  const auto renderer = client::TrialRenderer::Create(parts, client::KinectV2());
  std::vector<Seen> out;
  if (!plan.ok() || !renderer.ok()) return out;
  for (const client::PlannedCapture& capture : *plan) {
    const auto trial = renderer->Render(capture);
    if (!trial.ok()) continue;
    recognition::StageLog log;
    auto found = recognition::SegmentScan(
        trial->scan, {}, {}, [] { return false; }, &log);
    if (!found.ok() || found->segments.empty()) continue;
    const client::Placement& placed = capture.placements.front();
    out.push_back({placed.part, placed.world_object, capture.world_sensor,
                   std::move(found->segments.front().cloud)});
  }
  return out;
}

// The same as if the thing had been made longer or shorter along its axes.
OrientedCloud Stretched(const Seen& seen, const Eigen::Vector3f& factors) {
  const Eigen::Isometry3f world_object = seen.world_object.cast<float>();
  const Eigen::Isometry3f object_world = world_object.inverse();
  OrientedCloud out;
  for (std::size_t i = 0; i < seen.cloud.points.size(); ++i) {
    out.points.emplace_back(world_object *
                            (object_world * seen.cloud.points[i]).cwiseProduct(factors));
    out.normals.emplace_back(
        world_object.linear() *
        (object_world.linear() * seen.cloud.normals[i]).cwiseQuotient(factors).normalized());
  }
  return out;
}

}  // namespace

Catalogue::Catalogue(std::size_t view_count) {
  const std::vector<client::Workpiece> parts = client::SampleParts();
  const std::vector<Seen> seen = SeeParts(parts);
  if (seen.empty()) {
    std::fprintf(stderr, "graspdb_bench: the simulated camera shows no part\n");
    std::exit(1);
  }
  auto poses =
      std::make_shared<std::unordered_map<std::string, std::shared_ptr<const TaughtStablePose>>>();
  std::vector<IndexedView> indexed;
  std::mt19937_64 random(kSeed);
  const auto factor = [&] { return 0.6F + static_cast<float>(random() % 1000) / 1000.0F; };
  for (std::size_t variant = 0; indexed.size() < view_count; ++variant) {
    std::vector<Eigen::Vector3f> factors(parts.size(), Eigen::Vector3f::Ones());
    std::vector<std::shared_ptr<TaughtStablePose>> made(parts.size());
    for (std::size_t p = 0; p < parts.size(); ++p) {
      if (variant > 0) factors[p] << factor(), factor(), factor();
      made[p] = std::make_shared<TaughtStablePose>();
      made[p]->name = absl::StrFormat("objects/%s-%d/stablePoses/%s", parts[p].object_id, variant,
                                      parts[p].stable_pose_id);
      made[p]->symmetry_order = parts[p].symmetry_order;
      made[p]->grasps.push_back({.id = "top"});
    }
    for (const Seen& s : seen) {
      if (indexed.size() == view_count) break;
      const auto cloud = std::make_shared<const OrientedCloud>(Stretched(s, factors[s.part]));
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
