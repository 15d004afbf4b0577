#include "recognition/taught.h"

namespace graspdb::recognition {

bool HaveSameModel(const TaughtView& a, const TaughtView& b) {
  return a.name == b.name || (a.stable_pose == b.stable_pose && a.shares_frame && b.shares_frame);
}

std::vector<const TaughtView*> ViewsOfModel(const TaughtView& view,
                                            const TaughtStablePose& stable_pose) {
  std::vector<const TaughtView*> out;
  for (const auto& other : stable_pose.views) {
    if (HaveSameModel(view, *other)) out.push_back(other.get());
  }
  return out;
}

}  // namespace graspdb::recognition
