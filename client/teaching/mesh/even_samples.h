// Points on the surface of a mesh that do not depend on its triangles.
#pragma once

#include <vector>

#include "recognition/base/types.h"
#include "rendering/meshes/mesh.h"

namespace graspdb::client {

// Points with the outward normals of their triangles, and the area that each stands for, m^2.
struct EvenSamples {
  recognition::OrientedCloud cloud;
  std::vector<double> areas;
};

// About `count` points, at most twice that, so that triangles made to lie along its lines do not
// fill the memory: where the surface crosses the lines of a grid, each triangle those
// along the axis that its normal is nearest to. The same surface gives the same points however it
// is divided into triangles, up to rounding. Random points would not, and with them the first of
// several equal grasps. Deterministic.
EvenSamples SampleEvenly(const rendering::TriangleMesh& mesh, int count);

}  // namespace graspdb::client
