#include "server/taught_poses.h"

#include <algorithm>
#include <map>
#include <utility>

namespace graspdb::server {

using recognition::TaughtStablePose;

std::string PoseOfView(const std::string& view) { return view.substr(0, view.rfind("/views/")); }

namespace {

std::map<std::string, recognition::PickCounts> PicksOf(const TaughtStablePose& pose) {
  std::map<std::string, recognition::PickCounts> out;
  for (const recognition::TaughtGrasp& grasp : pose.grasps) out[grasp.id] = grasp.picks;
  return out;
}

void SetPicks(const std::map<std::string, recognition::PickCounts>& picks, TaughtStablePose* pose) {
  for (recognition::TaughtGrasp& grasp : pose->grasps) {
    const auto known = picks.find(grasp.id);
    grasp.picks = known == picks.end() ? recognition::PickCounts() : known->second;
  }
}

}  // namespace

TaughtPoses Changed(const TaughtPoses& poses, const TaughtPoseChange& change) {
  std::map<std::string, TaughtStablePose> edited;
  const auto edit = [&](const std::string& name) -> TaughtStablePose& {
    const auto [at, is_new] = edited.try_emplace(name);
    if (!is_new) return at->second;
    const auto found = poses.find(name);
    if (found != poses.end()) at->second = *found->second;
    at->second.name = name;
    return at->second;
  };
  for (const TaughtStablePose& written : change.written) {
    TaughtStablePose& pose = edit(written.name);
    auto views = std::move(pose.views);
    const auto picks = PicksOf(pose);
    pose = written;
    pose.views = std::move(views);
    SetPicks(picks, &pose);
  }
  for (const std::string& name : change.removed_views) {
    std::erase_if(edit(PoseOfView(name)).views,
                  [&](const auto& view) { return view->name == name; });
  }
  for (const auto& view : change.added_views) {
    auto& views = edit(view->stable_pose).views;
    views.insert(std::ranges::lower_bound(views, view->name, {},
                                          [](const auto& other) { return other->name; }),
                 view);
  }
  for (const TaughtOutcomes& outcomes : change.outcomes) {
    SetPicks(outcomes.picks, &edit(outcomes.stable_pose));
  }
  for (const std::string& name : change.deleted) edited.erase(name);

  TaughtPoses out = poses;
  for (const std::string& name : change.deleted) out.erase(name);
  for (auto& [name, pose] : edited) {
    out[name] = std::make_shared<const TaughtStablePose>(std::move(pose));
  }
  return out;
}

}  // namespace graspdb::server
