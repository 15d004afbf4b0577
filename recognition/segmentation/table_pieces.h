// Whether a plane is a table, and pieces of the table that stand out of its plane.
#pragma once

#include "recognition/base/cancellation.h"
#include "recognition/base/stages.h"
#include "recognition/base/types.h"
#include "recognition/points/plane.h"
#include "recognition/points/scan.h"
#include "recognition/segmentation/segmentation.h"

namespace graspdb::recognition {

// The first two functions take some thousand of a scan's points, in metres, and look at those
// within `distance_m` of the plane. O(n), about 1 ms. Thread-safe. Source and figures:
// docs/adr/0040-frames-without-a-table.md.

// Whether most of these points lie on a surface: of what is within 3 cm of such a point, nearly all
// is near the plane. The feet of objects on a table that is too black to be measured are a layer of
// points as well, but no surface. Any frame.
bool IsSurface(const Plane& plane, const Points& points, double distance_m);

// Whether these points are wide enough for a table, in metres or as the sensor sees them. A
// narrower plane is a face of an object. Sensor frame.
bool IsWideEnough(const Plane& plane, const Points& points, double distance_m);

// Removes segments that are pieces of the table. The depth of a camera is distorted, by 3 to 6 mm
// over the image at 1 m (docs/experiment.md), and tables are not flat: somewhere the table is
// higher above its plane than table_reach_m. Such a piece is as flat as the table, ends a few
// millimetres above table_reach_m, and begins where the table around it has slowly risen almost as
// high. A plate begins with a step, and the side of a dome is steeper.
//
// Logs a step "table_pieces", with the voxels of all segments, where one is removed. O(n) in the
// voxels and, where a segment is as low and flat as that, in the points of the scan. Needs normals
// and a table, else does nothing. Where cancelled, the result is meaningless.
void RemoveTablePieces(const Scan& scan, const IsCancelled& is_cancelled, StageLog* log,
                       Segmentation* segmentation);

}  // namespace graspdb::recognition
