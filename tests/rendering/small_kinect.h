// A small camera and the sample parts, for tests.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "rendering/camera/depth_camera.h"
#include "rendering/sample_parts.h"
#include "rendering/workpiece.h"

namespace graspdb::testing {

// The middle of a Kinect v2's image at full resolution, enough for a target at the centre.
inline rendering::DepthCameraModel SmallKinectV2() {
  rendering::DepthCameraModel model = rendering::KinectV2();
  model.intrinsics = {
      .width = 256, .height = 212, .fx = 365.5, .fy = 365.5, .cx = 127.5, .cy = 105.5};
  return model;
}

// The sample part of the given id; a failure and an empty one for an unknown id.
inline const rendering::Workpiece& PartNamed(const std::string& id) {
  static const std::vector<rendering::Workpiece> parts = rendering::SampleParts();
  for (const rendering::Workpiece& part : parts) {
    if (part.object_id == id) return part;
  }
  ADD_FAILURE() << "no sample part " << id;
  static const rendering::Workpiece none;
  return none;
}

}  // namespace graspdb::testing
