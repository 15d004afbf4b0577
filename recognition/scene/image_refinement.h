// Alignment of a model with a frame, without a search for neighbours.
#pragma once

#include "recognition/frame/frame.h"
#include "recognition/pairs/pair_model.h"

namespace graspdb::recognition {

struct ImageRefinementParameters {
  int iterations = 7;
  // Measurements farther from the surface are left out, m: at first and at last.
  float first_reach_m = 0.020F;
  float last_reach_m = 0.008F;
  std::size_t max_points = 200;
  // Between the normals of model and measurement.
  float min_normal_cosine = 0.5F;
};

// Point to plane with projective association (Blais and Levine 1995): each visible point of the
// model is compared with the measurement of its pixel, along the mean of both normals (Rusinkiewicz
// 2019). Deterministic; O(iterations * max_points).
Eigen::Isometry3f RefineInImage(const Frame& frame, const PairModel& model,
                                Eigen::Isometry3f sensor_object,
                                const ImageRefinementParameters& parameters);

// How well the frame constrains a pose, as a share of how well the complete visible surface would,
// in the direction where that is least: 0 to 1.
float InformationOf(const Frame& frame, const ImageModel& model, const ModelAspect& aspect,
                    const Eigen::Isometry3f& sensor_object,
                    const ImageRefinementParameters& parameters);

}  // namespace graspdb::recognition
