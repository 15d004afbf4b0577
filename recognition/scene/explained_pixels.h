// Pixels that posed models explain.
#pragma once

#include <vector>

#include "recognition/frame/frame.h"
#include "recognition/pairs/image_model.h"

namespace graspdb::recognition {

// For each pixel of the frame, whether it shows the posed model: some millimetres beside its
// visible points, at most 12 mm nearer or farther. `sensor_model`: T_sensor_model.
std::vector<bool> PixelsOn(const Frame& frame, const ImageModel& model,
                           const Eigen::Isometry3f& sensor_model);

// Object pixels become explained ones.
void Explain(const std::vector<bool>& pixels, Frame* frame);

// The share of these pixels that are explained already; 1 where there are none.
double ExplainedShare(const Frame& frame, const std::vector<bool>& pixels);

// The area of object pixels that nothing explains, m2, as seen from the sensor. Only blocks of
// pixels without any explained one count: what is left around an explained object is its edge.
double UnexplainedArea(const Frame& frame);

}  // namespace graspdb::recognition
