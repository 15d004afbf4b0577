// GSH-288, a histogram about gravity and the line of sight: our own descriptor.
//
// VFH and MVFH measure angles against the mean normal of the points, so that their histograms
// hardly change when a surface is mirrored or turned about that normal (a flat face at +30 and -30
// degrees gives the same bins). GSH-288 also uses gravity and the viewpoint. In the frame that
// these two span, with the centroid as origin, x on the horizontal line to the viewpoint and z up,
// it takes three two-dimensional histograms:
//   16 x 6  directions of the normals: azimuth, z component
//   12 x 8  positions, seen from the viewpoint: to the side, up
//   12 x 8  positions, seen from the side: towards the viewpoint, up
#pragma once

#include "recognition/descriptors/descriptor.h"

namespace graspdb::recognition {

// Describes a valid `cloud` (metres, unit normals; see Describe), z up, as a sensor at `sensor`
// (T_cloud_sensor) sees it. Every part has the same mass, the whole has mass 1. A count is shared
// between the bins around it by distance. Does not depend on the order of the points, on where the
// object stands, nor on a turn about z of cloud and sensor together. Where the sensor looks
// straight down, the lower side of its image replaces the line of sight (SideSeen). Never fails.
Descriptor DescribeGsh288(const OrientedCloud& cloud, const Pose& sensor);

}  // namespace graspdb::recognition
