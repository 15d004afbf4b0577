// A frame of a real camera with the answers drawn into it.
#pragma once

#include "lab/experiment/real_frames.h"
#include "pictures/shaded_picture.h"

namespace graspdb::lab {

// The scan (sensor frame, m) from its camera, darker where it is farther, and the visible points of
// the posed models: of right answers green, of wrong ones red, of objects that were not found, at
// their true pose, yellow. Measurements that are not finite or behind the camera are left out;
// pixels without one are black. O(n) in the points.
pictures::ShadedPicture DrawFrame(const FrameResult& result, const recognition::Points& scan);

}  // namespace graspdb::lab
