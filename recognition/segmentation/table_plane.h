// Whether a plane in a scan can be the table.
#pragma once

#include "recognition/base/types.h"
#include "recognition/points/plane.h"

namespace graspdb::recognition {

// Of some thousand of the points each, in metres, those within `distance_m` of the plane. O(n),
// about 1 ms. Thread-safe. Source and figures: docs/adr/0040-frames-without-a-table.md.

// Whether most of these points lie on a surface: of what is within 3 cm of such a point, nearly all
// is near the plane. The feet of objects on a table that is too black to be measured are a layer of
// points as well, but no surface. Any frame.
bool IsSurface(const Plane& plane, const Points& points, double distance_m);

// Whether these points are wide enough for a table, in metres or as the sensor sees them. A
// narrower plane is a face of an object. Sensor frame.
bool IsWideEnough(const Plane& plane, const Points& points, double distance_m);

}  // namespace graspdb::recognition
