// Parameters of the segmentation, with unit and default.
#pragma once

namespace graspdb::recognition {

// How an object's points are found in a frame. May differ from cell to cell.
struct SegmentationParameters {
  // Points farther from the sensor are left out, m: cells are smaller, and depth cameras for them
  // measure up to 6 m. Doubled, more of the space behind a cell costs time.
  double max_range_m = 10;
  // Maximum side of one object, m, of those that a robot lifts off a table. Doubled, a segmented
  // scan with stray points takes up to four times the memory.
  double max_object_size_m = 1;
  // Points nearer to the table plane than this belong to the table, m.
  double plane_distance_m = 0.006;
  // How far the table may be tilted against the world's z axis when the sensor
  // pose is known, rad.
  double plane_max_tilt_rad = 0.17;
  // How far the table may lie from z = 0 when the sensor pose is known, m.
  double plane_max_offset_m = 0.03;
  // A plane needs this share of the points in the region.
  double plane_min_share = 0.10;
  // Neighbours in the statistical outlier removal; 0 turns it off.
  int outlier_neighbor_count = 50;
  // Points whose mean neighbour distance lies more than this many standard deviations above the
  // mean are outliers.
  double outlier_deviation_factor = 2.0;
  // Clusters are farther apart than this, m.
  double cluster_tolerance_m = 0.015;
  // Clusters with fewer voxels than this are left out; at least 10.
  int min_cluster_point_count = 50;
};

}  // namespace graspdb::recognition
