#include "server/live/taught_poses.h"

#include <algorithm>
#include <map>
#include <string_view>
#include <unordered_set>
#include <utility>

namespace graspdb::server {

using recognition::TaughtStablePose;
using Views = std::vector<std::shared_ptr<const recognition::TaughtView>>;

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

// The removed and added views of one stable pose.
struct ViewChange {
  std::unordered_set<std::string_view> removed;
  Views added;
};

// Sorted by name again, in one pass: a change may affect all views of a stable pose.
void ApplyTo(ViewChange change, Views* views) {
  const auto name = [](const auto& view) -> const std::string& { return view->name; };
  std::erase_if(*views, [&](const auto& view) { return change.removed.contains(view->name); });
  std::ranges::stable_sort(change.added, {}, name);
  const auto old_size = static_cast<std::ptrdiff_t>(views->size());
  views->insert(views->end(), change.added.begin(), change.added.end());
  std::ranges::inplace_merge(*views, views->begin() + old_size, {}, name);
}

std::map<std::string, ViewChange> ViewChangesOf(const TaughtPoseChange& change) {
  std::map<std::string, ViewChange> out;
  for (const std::string& name : change.removed_views) out[PoseOfView(name)].removed.insert(name);
  for (const auto& view : change.added_views) out[view->stable_pose].added.push_back(view);
  // Their views go with them.
  for (const std::string& name : change.deleted) out.erase(name);
  return out;
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
  for (auto& [name, views] : ViewChangesOf(change)) ApplyTo(std::move(views), &edit(name).views);
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
