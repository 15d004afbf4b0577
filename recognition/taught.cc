#include "recognition/taught.h"

namespace graspdb::recognition {

std::vector<const TaughtView*> ViewsOfModel(const TaughtView& view,
                                            const TaughtStablePose& stable_pose) {
  std::vector<const TaughtView*> out;
  for (const auto& other : stable_pose.views) {
    if (view.shares_frame ? other->shares_frame : other->name == view.name) {
      out.push_back(other.get());
    }
  }
  return out;
}

}  // namespace graspdb::recognition
