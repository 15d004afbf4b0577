// Clouds made by code, the same for the same seed.
#pragma once

#include <random>

#include "recognition/base/types.h"

namespace graspdb::testing {

using Random = std::mt19937_64;

double Uniform(Random& random, double lo, double hi);

Eigen::Vector3d RandomDirection(Random& random);

// Any rotation, and a shift of at most `max_shift_m` along each axis.
recognition::Pose RandomPose(Random& random, double max_shift_m);

// A turn of `angle_rad` about a random axis through `center`, and a shift of
// `shift_m` in a random direction.
recognition::Pose RandomMotion(Random& random, const Eigen::Vector3d& center, double angle_rad,
                               double shift_m);

// `count` points in a box of edge `size_m` about the origin.
recognition::Points RandomPoints(Random& random, std::size_t count, double size_m);

// `count` random points of a wavy patch of about 12 x 9 cm about the origin, without any
// symmetry, with its true normals (z > 0).
recognition::OrientedCloud WavySurface(Random& random, std::size_t count);

// The cloud moved in double precision and rounded to float.
recognition::OrientedCloud Moved(const recognition::Pose& pose,
                                 const recognition::OrientedCloud& cloud);

recognition::OrientedCloud Reordered(Random& random, recognition::OrientedCloud cloud);

// Points and normals mirrored at the plane x = 0.
recognition::OrientedCloud MirroredInX(recognition::OrientedCloud cloud);

}  // namespace graspdb::testing
