// Pieces of the table that stand out of its plane.
#pragma once

#include "recognition/base/cancellation.h"
#include "recognition/base/stages.h"
#include "recognition/points/scan.h"
#include "recognition/segmentation/segmentation.h"

namespace graspdb::recognition {

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
