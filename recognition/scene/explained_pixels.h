// Pixels that posed models explain.
#pragma once

#include <cstddef>
#include <vector>

#include "recognition/frame/frame.h"
#include "recognition/pairs/image_model.h"

namespace graspdb::recognition {

// Indices of pixels in a frame, ascending. A model covers a small part of it.
using Pixels = std::vector<std::size_t>;

// The pixels that show the posed model: some millimetres beside its visible points, at most 12 mm
// nearer or farther. `sensor_model`: T_sensor_model. O(points + pixels).
Pixels PixelsOn(const Frame& frame, const ImageModel& model, const Eigen::Isometry3f& sensor_model);

// Object pixels become explained ones.
void Explain(const Pixels& pixels, Frame* frame);

// The share of these pixels that are explained already; 1 where there are none.
double ExplainedShare(const Frame& frame, const Pixels& pixels);

// The area of object pixels that nothing explains, m2, as seen from the sensor. Only blocks of
// pixels without any explained one count: what is left around an explained object is its edge.
double UnexplainedArea(const Frame& frame);

}  // namespace graspdb::recognition
